# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of ``accuracy`` as data: small pictures whose light is known.

``scenes`` builds them in Blender, ``mitsuba_scenes`` in Mitsuba.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

BRIGHTEST = 3.0  # the environment map is cut there: its truth would need too many samples else
DISTANCE, LENS, SENSOR = 6.0, 90.0, 36.0  # of the camera from the unit ball, in metres and millimetres
LAMP_LOCATION, LAMP_DEGREES = (1.3, -1.6, 2.6), (45.0, 39.0)  # metres; rotation about x, then z
SOFTBOX_WATTS, SOFTBOX_SIDE = 60.0, 1.0  # metres
SUN_STRENGTH, SUN_ANGLE = 2.0, radians(0.53)  # W/m^2; across its disc
CHECKER_CAMERA, CHECKER_DEGREES = (0.0, -5.6, 2.6), 74.0  # a little above the floor
CHECKER_LEVELS, CHECKER_SIDE, FLOOR_HALF = (0.05, 0.7), 0.5, 40.0  # reflectances; metres


@dataclass(frozen=True)
class SceneKind:
    """A ball and its light. light: Automatic's name for it. world: grey level where there is no map. lamp: its type.

    formula: whether the model's formula alone says what an opaque ball shows.
    """

    title: str
    light: str
    mapped: bool = False
    world: float = 0.0
    lamp: str = ""
    floor: bool = False
    formula: bool = True

    @property
    def rarely_hit(self) -> bool:
        """Whether the light is so small that random rays rarely hit it."""
        return self.lamp == "SUN"


SCENES = {
    # Each pixel of the gonioreflectometer is a direction, and the truth is the reference's albedo.
    "furnace": SceneKind("white furnace", "even", formula=False),
    "environment": SceneKind("environment map", "picture", mapped=True),
    "softbox": SceneKind("softbox", "lights", lamp="AREA"),
    "sun": SceneKind("half-degree sun", "lights", world=0.05, lamp="SUN"),
    "outdoors": SceneKind("environment map and sun", "picture and lights", mapped=True, lamp="SUN"),
    "checker": SceneKind("checkered floor", "picture", mapped=True, floor=True, formula=False),
}
