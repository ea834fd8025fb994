# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that change over time, and what they are at a frame."""

import numpy as np

from vgroove import headless
from vgroove.addon.blender import course, material
from vgroove.addon.blender.course import Play
from vgroove.addon.blender.inputs import scale_of
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library.presets import parse, shipped
from vgroove.addon.reference import local_age
from vgroove.lab.check.rows import SETUPS
from vgroove.nodegroups import trajectory

CHANGING = sorted(preset.id for preset in shipped().values() if preset.time)
SHORT = "time_varying/rusting_iron", "time_varying/curing_lacquer", "time_varying/heat_tinted_steel"
SVM_AND_OSL = (SETUPS[0], SETUPS[2])
EPS = 2.0**-24
# Flash of two colours and a slope with a kink: rates apart by 1e5
STIFF = """name = "Stiff"
model = "sum"
d = 0.6
s = 0.4
albedo = [0.8, 0.2, 0.1]
sigma = 0.3
m = 0.1
[fresnel]
f0 = [0.9, 0.6, 0.5]
[source]
data = "test"
[time]
unit = "h"
range = [0.0, 10.0]
kind = "authored"
[time.albedo]
law = "exponential"
end = [0.1, 0.5, 0.1]
rates = [1e5, 0.3]
shares = [0.5, 0.5]
[time.m]
law = "keys"
times = [2.0, 2.001, 10.0]
values = [0.2, 0.6, 0.3]
[time.d]
law = "polynomial"
coefficients = [-0.5]
"""


def stiff():
    return parse(STIFF, "test/stiff", "stiff.toml")


def made(blender, preset, backend="nodes", estimator="fit", **play):
    """A material that plays its course, on an object of the scene so that Blender evaluates it."""
    with headless.quiet():
        one = build(preset, Choice(backend, estimator, play=Play(**play)))
    mesh = blender.data.meshes.new("Plane")
    mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(one)
    blender.context.scene.collection.objects.link(blender.data.objects.new("Plane", mesh))
    return one


def shown(one, frame):
    """The parameters of a material at a frame, as its curves or its trajectory's keys have them."""
    import bpy

    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    sockets = material.parameter_sockets(one)
    values = {
        name: np.array(of.default_value)[:3] if of.type in {"RGBA", "VECTOR"} else np.array(of.default_value)
        for name, of in sockets.items()
    }
    node = course.trajectory_node(one)
    if node is not None:
        age = node.inputs["Age"].default_value
        local = local_age(age, node.inputs["Rate"].default_value, node.inputs["Offset"].default_value)
        for label, played in trajectory.keys_of(node.node_tree).items():
            name = next(name for name, socket in sockets.items() if socket.name == label)
            ages, points = (np.array(part) for part in zip(*played, strict=True))
            values[name] = course.Keys(ages, points)(local)
    return {name: scale_of(name, sockets[name]).of_input(value) for name, value in values.items()}
