# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured BRDFs: files read, evaluated, described and written. Imports NumPy, and no bpy.

>>> from vgroove.addon.reference import Lambert
>>> from vgroove.addon.measured import Merl, tabulate
>>> grey = Merl(tabulate(Lambert(0.5).evaluate))
>>> float(round(grey.evaluate([0, 0, 1], [0, 0, 1])[0], 6))
0.159155
"""

from ..models.measured import READERS
from .csv_file import write_csv
from .library import open_table
from .merl import Merl, tabulate, write_merl
from .reading import ENDINGS, read
from .summary import Summary, summarize
from .table import Contents, Table

READERS[:] = [open_table]

__all__ = [
    "ENDINGS",
    "Contents",
    "Merl",
    "Summary",
    "Table",
    "open_table",
    "read",
    "summarize",
    "tabulate",
    "write_csv",
    "write_merl",
]
