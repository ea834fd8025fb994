# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove fit``: a preset whose lobes come nearest to a measured BRDF."""

from __future__ import annotations

import time
from enum import StrEnum
from pathlib import Path  # noqa: TC003 (typer reads annotations)
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer
from rich.table import Table

from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, replacing, write_text
from ..addon.measured.as_preset import Source
from ..addon.measured.fit import ANGLES, METRICS
from ..addon.measured.lobes import KINDS
from ..addon.models import DEFAULT
from ..addon.models import measured as measured_model
from .environment import require_packages
from .info import FileArgument  # noqa: TC001 (typer reads annotations)
from .options import whole
from .terminal import out, say

if TYPE_CHECKING:
    from ..addon.measured.fit import Fit

if TYPE_CHECKING:
    Metric: TypeAlias = StrEnum
    Model: TypeAlias = StrEnum
else:
    Metric = StrEnum("Metric", {name.upper(): name for name in METRICS})
    Model = StrEnum("Model", {name.upper(): name for name in (*KINDS, measured_model.MODEL.name)})
L1, PLAIN = Metric("l1"), Model(DEFAULT)

MODEL_HELP = (
    "cook_torrance: lobes over Oren-Nayar; generator: ABC facets over Lambert; ward: a Gaussian over Lambert; "
    "measured: the table as it is"
)
LOBES_HELP = "How many lobes it may have: 2 if not given; generator: at most 3, ward: 1"
PLOT_HELP = "Also the residual by the angle of the light, as .png or .svg"
METRIC_HELP = "; ".join(f"{name}: {text}" for name, text in METRICS.items())


def fit(
    file: FileArgument,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE.toml", help="The preset")],
    *,
    lobes: Annotated[int | None, typer.Option(parser=whole(1, 4), metavar="N", help=LOBES_HELP)] = None,
    model: Annotated[Model, typer.Option(help=MODEL_HELP)] = PLAIN,
    metric: Annotated[Metric, typer.Option(help=METRIC_HELP)] = L1,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE", help=PLOT_HELP)] = None,
) -> None:
    """Fit a diffuse part and lobes to a measured BRDF, and write them as a preset."""
    from ..addon.library import writing
    from ..addon.library.presets import parse

    if output.suffix.lower() != ".toml":
        message = f"{output}: presets are TOML files; name one that ends in .toml"
        raise InputError(message)
    most = KINDS[model].most if model in KINDS else 4
    lobes = min(2, most) if lobes is None else lobes
    if lobes > most:
        message = f"--lobes: {model} has at most {most}, got {lobes}"
        raise InputError(message)
    check_writable(output)
    if plot is not None:
        _check_plot(plot, model)
    start = time.perf_counter()
    source = Source.read(file)
    if model == measured_model.MODEL.name:
        _write_table(output, source)
        return
    found = list(source.fits(lobes, model, metric))
    text = writing.dumps(found[-1].preset)
    parse(text, found[-1].preset.id, str(output))
    write_text(output, text)
    out.print("share of the reflected light that differs, in %:")
    out.print(_residuals(found))
    nearer = found[0].mean / max(found[-1].mean, 1e-12)
    if plot is not None:
        _plot(plot, f"{source.name}: {model}, metric {metric}", found)
        say(f"wrote {plot}")
    says = f"{lobes} lobes are {nearer:.2f} times nearer than one; " if lobes > 1 else ""
    say(f"{says}metric {metric}: {METRICS[metric]}; {time.perf_counter() - start:.1f} s")
    say(f"wrote {output}")


def _write_table(output: Path, source: Source) -> None:
    """The preset that names the table, without a folder if both lie in one."""
    from ..addon.library import writing

    file = source.path
    together = file.absolute().parent == output.absolute().parent
    stored = file.name if together else str(file.absolute())
    write_text(output, writing.dumps(source.as_table(stored)))
    say(f"wrote {output}, which names {stored}; keep both")


def _check_plot(path: Path, model: str) -> None:
    """InputError, before any work, if there would be no figure."""
    if path.suffix.lower() not in {".png", ".svg"}:
        message = f"{path}: unknown ending; use .png or .svg"
        raise InputError(message)
    if model not in KINDS:
        message = f"--plot shows what a fit leaves; --model {model} leaves nothing"
        raise InputError(message)
    check_writable(path)
    require_packages("matplotlib", what=f"a {path.suffix} file")


def _plot(path: Path, title: str, found: list[Fit]) -> None:
    from ..lab import plots

    figure = plots.residuals(ANGLES, {_lobes(one): one.residual for one in found}, title)
    with replacing(path) as temporary:
        temporary.write_bytes(plots.png(figure) if path.suffix.lower() == ".png" else plots.svg(figure))


def _lobes(one: Fit) -> str:
    return f"{one.lobes} lobe{'s' * (one.lobes > 1)}"


def _residuals(found: list[Fit]) -> Table:
    """Share of the reflected light that differs, in per cent."""
    table = Table("light at", *map(_lobes, found))
    for index, angle in enumerate(ANGLES):
        table.add_row(f"{angle} degrees", *(f"{100.0 * one.residual[index]:.2f}" for one in found))
    table.add_row("mean", *(f"{100.0 * one.mean:.2f}" for one in found))
    return table
