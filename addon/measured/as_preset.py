# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of measured values as a preset: the table itself, or what is fitted to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..library.errors import InputError
from ..library.files import FileError
from ..library.preset import Preset
from ..models import MeasuredTable
from ..models import measured as measured_model
from .fit import fits
from .library import digest_of, open_table
from .reading import read

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .fit import Fit
    from .table import Table

FITTED = " (fit)"
LONGEST_NAME = 60


def check_opaque(preset: Preset) -> None:
    """InputError for what a table of reflectance cannot hold."""
    if preset.transparent:
        message = f"{preset.id} lets light through, which a MERL table cannot hold; choose an opaque preset"
        raise InputError(message)


@dataclass(frozen=True)
class Source:
    """A file that was read."""

    path: Path
    digest: str  # SHA-256 of its content
    table: Table

    @classmethod
    def read(cls, path: Path) -> Source:
        """FileError, in one line, for a file that holds no measured BRDF."""
        table = read(path)
        return cls(path, digest_of(path), table)

    @property
    def name(self) -> str:
        """Of presets: the file's, without what no text may hold."""
        return "".join(c for c in " ".join(self.path.stem.split()) if c.isprintable()).strip() or "Measured"

    @property
    def data(self) -> str:
        """Where a preset's numbers come from."""
        name = "".join(c if c.isprintable() else "?" for c in self.path.name)
        return f"{name}, {self.table.contents.format}, sha256 {self.digest[:16]}"

    def as_table(self, stored: str) -> Preset:
        """The preset that names the table, as the file ``stored``. FileError if no material can look it up."""
        open_table(MeasuredTable(str(self.path), self.digest))
        source = {"data": self.data, "colour": "measured", "roughness": "measured"}
        of = measured_model.MODEL
        table, kind = MeasuredTable(stored, self.digest), next(iter(of.kinds))
        return Preset("mine/table", self.name[:LONGEST_NAME], of.name, kind, {}, source, ("measured",), table=table)

    def fits(self, lobes: int, kind: str, metric: str) -> Iterator[Fit]:
        """``fit.fits`` by a name of its own; FileErrors name the file."""
        name = f"{self.name[: LONGEST_NAME - len(FITTED)]}{FITTED}"
        try:
            yield from fits(self.table, name, self.data, lobes, kind, metric)
        except FileError as error:
            message = f"{self.path}: {error}"
            raise FileError(message) from error
