# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of rows of ``vgroove check`` share."""


def name(row):
    """The function that measures a row and its arguments, for pytest's ids."""
    numbers = (f"{part:.3g}" if isinstance(part, float) else str(part) for part in row.args)
    return "-".join([row.func.__name__, *numbers, *row.keywords]).replace(" ", "_")
