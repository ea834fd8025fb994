# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of measured values both ways, for an artist to choose: as a preset of its table, and as one fitted to it."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..blender import material, studio
from ..library import presets, writing
from ..library.files import write_text
from ..measured.as_preset import Source
from . import picture

if TYPE_CHECKING:
    from ..library.presets import Preset

METRIC = "l1"  # nearest in the light that goes elsewhere
SAMPLES = 64  # of the table's picture: its facets are random
TABLE, FIT = "table", "fit"


@dataclass(frozen=True)
class Compared:
    """What a folder holds once ``main`` has ended: FORM.toml and FORM.webp of both forms, and the residual."""

    folder: Path

    def preset(self, form: str) -> Preset:
        return presets.load(self._of(form, "toml"))

    def picture(self, form: str) -> Path:
        return self._of(form, "webp")

    @property
    def says(self) -> str:
        """How far the fit is from the table, in words."""
        return self._of(FIT, "txt").read_text(encoding="utf-8")

    def _of(self, form: str, ending: str) -> Path:
        return self.folder / f"{form}.{ending}"

    def write(self, source: Source, lobes: int, kind: str) -> None:
        """Both presets. FileError if the file allows one of them not."""
        write_text(self._of(TABLE, "toml"), writing.dumps(source.as_table(str(source.path.absolute()))))
        *_, last = source.fits(lobes, kind, METRIC)
        write_text(self._of(FIT, "toml"), writing.dumps(last.preset))
        write_text(self._of(FIT, "txt"), last.says)

    def render(self) -> None:
        """Both pictures, the fit as Standard has it; empties this session."""
        shown = studio.scene()
        picture.render(shown, self.preset(FIT), self.picture(FIT))
        shown.cycles.samples = SAMPLES
        table = self.preset(TABLE)
        studio.show(shown, table, material.build(table, material.Choice("nodes", "mirror")))
        studio.picture(shown, self.picture(TABLE))


def main() -> None:
    """In a Blender of its own: the command line's last four are the file, the folder, the lobes and their model."""
    file, folder, lobes, kind = sys.argv[-4:]
    of = Compared(Path(folder))
    of.write(Source.read(Path(file)), int(lobes), kind)
    of.render()
