# SPDX-License-Identifier: GPL-3.0-or-later
"""Three random numbers for each sample: Cycles hands shaders none, so a hash of position and direction stands in.

The pixel filter and every bounce move P, which makes the hash new from sample to sample. The fourth hash dimension
keeps streams apart: an offset added to P would be lost in rounding far from the origin.
"""

from . import ensure
from ._tree import Tree, Value

NAME = "VGroove Random"
REVISION = 1


def build(tree: Tree) -> None:
    stream = tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="A number of its own for each independent draw")
    with tree.frame("hash(P, stream + hash(I))"):
        direction = tree.node("ShaderNodeTexWhiteNoise", tree.geometry("Incoming"), noise_dimensions="3D")
        noise = tree.node("ShaderNodeTexWhiteNoise", tree.geometry("Position"), noise_dimensions="4D")
        tree.connect(stream + Value(tree, direction.outputs["Value"]), noise.inputs["W"])
    tree.output_vector("Random", Value(tree, noise.outputs["Color"]), tip="Three numbers in 0..1")


def random_numbers(tree: Tree, stream: float | Value) -> tuple[Value, Value, Value]:
    """u1, u2, u3 of ``stream``."""
    node = tree.group(ensure(NAME, REVISION, build), Stream=stream)
    return Value(tree, node.outputs["Random"]).xyz
