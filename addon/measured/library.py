# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables that presets name: read once, and checked to be those that the preset was made of."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path

from ..library.files import FileError
from ..models import MeasuredTable  # noqa: TC001 (lru_cache keeps it)
from ..reference.cook_torrance import CookTorrance
from ..reference.fresnel import Schlick
from ..reference.oren_nayar import Lambert
from ..reference.sum import Sum
from .merl import Merl, tabulate
from .model import Measured
from .reading import check_size, read

EXAMPLE = Sum(Lambert([0.6, 0.4, 0.2]), CookTorrance(0.2, Schlick(0.3)), 0.7, 0.3)


def digest_of(path: Path) -> str:
    """SHA-256 of a file that may be a measured BRDF, as presets state it. FileError or OSError if it cannot be read."""
    check_size(path)
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@lru_cache(maxsize=4)
def open_table(of: MeasuredTable) -> Measured:
    """The model of a preset's table. FileError if its file is missing, changed, damaged or anisotropic."""
    if not of.file:
        return Measured.of(Merl(tabulate(EXAMPLE.evaluate)), "Example")
    path = Path(of.file)
    try:
        found = digest_of(path)
    except OSError as error:
        message = f"{path}: {error.strerror or error}; the preset names it as its table: put it there again"
        raise FileError(message) from error
    if found != of.sha256:
        message = f"{path}: has changed since the preset was made (its SHA-256 is {found}); make the preset again"
        raise FileError(message)
    table = read(path)
    try:
        return Measured.of(table, of.sha256[:12])
    except ValueError as error:
        message = f"{path}: {error}; fit it, or take an isotropic measurement"
        raise FileError(message) from error
