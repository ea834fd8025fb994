# SPDX-License-Identifier: GPL-3.0-or-later
"""Which format a file has, by its content, and what a file may be at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..library.files import FileError, check_regular, read_bytes
from . import astm, merl, rgl, tensor, utia

if TYPE_CHECKING:
    from os import PathLike

    from .table import Table

ENDINGS = (".binary", ".bsdf", ".astm", ".bin", ".csv")  # by which a name is taken for a file's, though none is there
MOST_BYTES = 2**29  # the largest files of these formats, spectral and anisotropic, have a fifth of that


def read(path: str | PathLike[str]) -> Table:
    """The measured BRDF in a file, whose format its content shows. FileError, in one line, for what is none.

    Memory stays under three times the file, but for text that writes numbers with fewer than six letters.
    """
    path = Path(path)
    try:
        with np.errstate(all="ignore"):  # what is no number is counted
            return _parsed(_content(path), path.suffix.lower())
    except FileError as error:
        message = f"{path}: {error}"
        raise FileError(message) from error


def _content(path: Path) -> bytes:
    try:
        check_regular(path)
        size = path.stat().st_size
    except FileError:
        raise
    except (OSError, ValueError):
        size = 0  # read_bytes says why
    if size > MOST_BYTES:
        message = f"has {size} bytes; measured BRDFs are read up to {MOST_BYTES}: leave out wavelengths or directions"
        raise FileError(message)
    return read_bytes(path, size)  # which reserves what it may read


def _parsed(content: bytes, ending: str) -> Table:
    if not content:
        message = "is empty; get it again"
        raise FileError(message)
    if content.startswith(tensor.MAGIC):
        return rgl.read_rgl(content)
    if ending == ".astm" or astm.is_astm(content):
        return astm.read_astm(content)
    if ending == ".binary" or merl.is_merl(content):
        return merl.read_merl(content)
    if ending == ".bin" or len(content) == utia.SIZE:
        return utia.read_utia(content)
    message = (
        "has none of the formats MERL .binary, RGL .bsdf, ASTM E1392 text and UTIA .bin; convert it to one of them"
    )
    raise FileError(message)
