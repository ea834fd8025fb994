# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts of tools/, as modules."""

import importlib
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def load(name):
    """A script under its own name, as those beside it import it."""
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(ROOT / "tools"))
