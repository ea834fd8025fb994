# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove plot``: BRDFs as figures, or their numbers as CSV."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..addon.library import presets
from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, replacing
from .environment import require_packages
from .options import SetOption, TimeOption, apply_settings, real
from .terminal import say

if TYPE_CHECKING:
    from ..addon.measured.curves import View


class Plot(StrEnum):
    """What is plotted, of ``curves.PLOTS``."""

    POLAR = "polar"
    LOBE = "lobe"
    THETA_O = "theta_o"
    THETA_H = "theta_h"
    THETA_D = "theta_d"
    ALBEDO = "albedo"
    SLICE = "slice"


class Times(StrEnum):
    """What f is multiplied by, of ``lobe.TIMES``."""

    ONE = "one"
    COS_O = "cos_o"
    COS_IO = "cos_io"


class Channel(StrEnum):
    """Which of a BRDF's numbers are drawn, of ``plots.CHANNELS``."""

    LUMINANCE = "luminance"
    RED = "red"
    GREEN = "green"
    BLUE = "blue"
    RGB = "rgb"


BrdfsArgument = Annotated[
    list[str],
    typer.Argument(
        metavar="PRESET|FILE...",
        help="Up to 8 presets, which may have parameters of their own (copper:m=0.1), and files of measured BRDFs",
    ),
]
OutputOption = Annotated[
    Path, typer.Option("-o", "--output", metavar="FILE", help="Figure as .png or .svg, or the numbers as .csv")
]
PlotOption = Annotated[
    Plot,
    typer.Option(
        "--plot",
        help="polar, theta_o: a slice through the hemisphere; lobe: all of it; theta_h, theta_d: over half and "
        "difference angle; slice: an image over both; albedo: share of a white sky that is reflected",
    ),
]
ThetaOption = Annotated[
    float,
    typer.Option(
        parser=real(0.0, 89.99), metavar="DEG", help="Angle of the light to the normal; with theta_h: theta_d"
    ),
]
PhiOption = Annotated[
    float, typer.Option(parser=real(-360.0, 360.0), metavar="DEG", help="Azimuth of the light, for brushed surfaces")
]
PhiOOption = Annotated[
    float,
    typer.Option(
        parser=real(-180.0, 180.0), metavar="DEG", help="Azimuth of the slice from the plane of incidence; 90: across"
    ),
]
ThetaHOption = Annotated[
    float, typer.Option(parser=real(0.0, 89.99), metavar="DEG", help="With --plot theta_d: the half angle")
]
PhiDOption = Annotated[
    float,
    typer.Option(
        parser=real(-180.0, 180.0), metavar="DEG", help="With theta_h, theta_d and slice: azimuth about the half vector"
    ),
]
LogOption = Annotated[bool, typer.Option("--log", help="Logarithmic: the four decades below the peak")]
TimesOption = Annotated[Times, typer.Option(help="Multiply f by 1, by cos theta_o, or by cos theta_i cos theta_o")]
ChannelOption = Annotated[Channel, typer.Option(help="What figures show; CSV has all of it")]


def plot(
    names: BrdfsArgument,
    output: OutputOption,
    *,
    settings: SetOption = None,
    at_time: TimeOption = None,
    kind: PlotOption = Plot.POLAR,
    theta_i: ThetaOption = 45.0,
    phi_i: PhiOption = 0.0,
    phi_o: PhiOOption = 0.0,
    theta_h: ThetaHOption = 0.0,
    phi_d: PhiDOption = 90.0,
    times: TimesOption = Times.ONE,
    channel: ChannelOption = Channel.LUMINANCE,
    log: LogOption = False,
) -> None:
    """Plot BRDFs of presets and measured files together. Needs no Blender."""
    ending = output.suffix.lower()
    if ending not in {".png", ".svg", ".csv"}:
        message = f"{output}: unknown ending; use .png, .svg or .csv"
        raise InputError(message)
    check_writable(output)
    if ending != ".csv":
        require_packages("matplotlib", what=f"a {ending} file")
    brdfs = named(names, settings, at_time)
    from ..addon.measured import curves

    view = curves.View(theta_i, phi_i, phi_o, theta_h, phi_d, str(times))
    content = (
        curves.csv_text(str(kind), curves.numbers(str(kind), brdfs, view), view).encode()
        if ending == ".csv"
        else _figure(ending, str(kind), brdfs, view, str(channel), log=log)
    )
    with replacing(output) as temporary:
        temporary.write_bytes(content)
    say(f"wrote {output}")


def named(texts: list[str], settings: list[str] | None = None, at_time: float | None = None) -> dict[str, Any]:
    """Presets and measured BRDFs by what they are called in a legend. InputError for what is neither, or is twice.

    settings, at_time: of all presets, before the parameters that a text gives for its own.
    """
    found: dict[str, Any] = {}
    for text in texts:
        name, brdf = _named(text, settings, at_time)
        if name in found:
            message = f"{text}: is there twice; leave one out, or give it parameters of its own, as in {text}:m=0.1"
            raise InputError(message)
        found[name] = brdf
    return found


def _named(text: str, settings: list[str] | None, at_time: float | None) -> tuple[str, Any]:
    from ..addon import measured

    if Path(text).suffix.lower() in measured.ENDINGS or Path(text).is_file():
        name = Path(text).name.encode("utf-8", "backslashreplace").decode()  # which may hold bytes that are no UTF-8
        return name, measured.read(text)
    name, *own = text.split(":")
    preset = presets.find(name)
    preset = apply_settings(preset, [*(settings or []), *own], at_time)
    return ", ".join([preset.id, *(one.replace("=", " = ") for one in own)]), preset


def _figure(ending: str, kind: str, brdfs: dict[str, Any], view: View, channel: str, *, log: bool) -> bytes:
    from ..lab import plots

    figure = plots.draw(kind, brdfs, view, channel=channel, log=log)
    return plots.png(figure) if ending == ".png" else plots.svg(figure)
