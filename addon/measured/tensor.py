# SPDX-License-Identifier: GPL-3.0-or-later
"""RGL's "tensor file": named arrays, little-endian.

"tensor_file" and a zero byte, two bytes of version (1, 0), uint32 number of fields; for each field uint16 length and
text of its name, uint16 number of dimensions, uint8 type, uint64 position in the file, a uint64 for each dimension.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from ..library.files import FileError

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAGIC = b"tensor_file\0"
VERSION = b"\1\0"
MOST_FIELDS, MOST_DIMENSIONS = 64, 8  # RGL's have 11 fields and at most 5 dimensions
TYPES = {1: "u1", 2: "i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<u8", 8: "<i8", 9: "<f2", 10: "<f4", 11: "<f8"}
COUNT = struct.Struct("<I")


class _Cursor:
    """Reads one item after the other."""

    def __init__(self, content: bytes, at: int) -> None:
        self.content, self.at = content, at

    def take(self, form: str) -> tuple[Any, ...]:
        end = self.at + struct.calcsize(form)
        if end > len(self.content):
            message = f"is cut off after {len(self.content)} bytes, within its list of fields; get the whole file"
            raise FileError(message)
        found = struct.unpack_from(form, self.content, self.at)
        self.at = end
        return found


def fields(content: bytes) -> dict[str, NDArray[Any]]:
    """The arrays in the bytes of a tensor file, as views of them; FileError says what is wrong."""
    cursor = _Cursor(content, len(MAGIC))
    (version,) = cursor.take("2s")
    if version != VERSION:
        message = f"is a tensor file of version {version[0]}.{version[1]}; only 1.0 can be read"
        raise FileError(message)
    (count,) = cursor.take("<I")
    if not 1 <= count <= MOST_FIELDS:
        swapped = int.from_bytes(COUNT.pack(count), "big")
        message = f"says that it has {count} fields, where {MOST_FIELDS} are the most; it is damaged, get it again"
        if 1 <= swapped <= MOST_FIELDS:
            message = "is a tensor file whose bytes are swapped (big-endian); convert it to little-endian"
        raise FileError(message)
    return dict(_field(cursor) for _ in range(count))


def _field(cursor: _Cursor) -> tuple[str, NDArray[Any]]:
    (length,) = cursor.take("<H")
    name = cursor.take(f"{length}s")[0].decode("utf-8", "backslashreplace")
    dimensions, kind = cursor.take("<HB")
    where = f'field "{name[:40]}"'
    if kind not in TYPES or dimensions > MOST_DIMENSIONS:
        message = f"{where} has type {kind} and {dimensions} dimensions, which no tensor file has; get the file again"
        raise FileError(message)
    (offset, *shape) = cursor.take(f"<{1 + dimensions}Q")
    kind = np.dtype(TYPES[kind])
    size = kind.itemsize
    for one in shape:
        size *= one
    if offset + size > len(cursor.content):
        text = " x ".join(map(str, shape))
        message = f"{where} ({text}) ends at byte {offset + size} of {len(cursor.content)}; get the whole file"
        raise FileError(message)
    return name, np.ndarray(tuple(shape), kind, cursor.content, offset)
