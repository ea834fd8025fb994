# SPDX-License-Identifier: GPL-3.0-or-later
"""The sockets by which a group takes its lamps: what ``lamp.py`` gives for each, direction and irradiance."""

from typing import TypeAlias

from ._tree import Tree, Value

Beams: TypeAlias = list[tuple[Value, Value]]


def beam_interfaces(tree: Tree, lamps: int) -> Beams:
    """Inputs "To Lamp" and "Irradiance" of each lamp, in a panel of its own."""
    beams = []
    for index in range(1, lamps + 1):
        with tree.panel(f"Lamp {index}"):
            wi = tree.input_vector(f"To Lamp {index}", (0, 0, 1), hide_value=True, tip="From the lamp's group")
            tip = "From the lamp's group, in W/m^2 across the beam"
            beams.append((wi, tree.input_color(f"Irradiance {index}", (0, 0, 0), tip=tip)))
    return beams
