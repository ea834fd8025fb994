# SPDX-License-Identifier: GPL-3.0-or-later
"""Three random numbers for each sample: Cycles hands shaders none, so a hash of what a ray brings stands in.

The pixel filter and every bounce move position and direction, which makes the hash new from sample to sample. Position
is rounded in world space, to 2^-24 of the distance from the origin; Parametric is rounded within its triangle, so it
still tells samples apart there, of things that move above all. It is (0, 0) where there is no triangle or curve.
The scene's seed tells renders apart where no ray does: Cycles sends a pixel's first sample through its middle whatever
the seed, so that pictures of several seeds would share its noise.
Each is hashed before it meets the next: a sum would lose the digits of the smaller.

Each independent draw has a stream of its own, listed here for node groups and for OSL: draws that share one are
correlated, and bias a product of both. Numbers in saved files and pictures depend on them: add, do not renumber.
"""

from __future__ import annotations

from . import ensure
from ._tree import Tree, Value, output, vector

NAME = ".VGroove Random"
REVISION = 4

MAX_LIGHTS = 50  # of one material
# A stream of node groups gives three numbers, which are independent of one another.
NODE_STREAMS = {"FACET": range(1, 2), "DIRECTION": range(2, 3), "LIGHT": range(10, 10 + MAX_LIGHTS)}
# A stream of OSL gives one number; shaders read these as STREAM_FACET_SLOPE and so on.
OSL_STREAMS = {
    "FACET_SLOPE": range(1, 2),
    "FACET_AZIMUTH": range(2, 3),
    "FACET_DUAL": range(3, 4),
    "DIRECTION_RADIUS": range(4, 5),
    "DIRECTION_AZIMUTH": range(5, 6),
    "LIGHT": NODE_STREAMS["LIGHT"],  # both backends read it from the material's light nodes
    "LIGHT_AZIMUTH": range(10 + MAX_LIGHTS, 10 + 2 * MAX_LIGHTS),
}


def build(tree: Tree) -> None:
    w = tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="A number of its own for each independent draw")
    with tree.frame("hash(P, hash(uv, hash(I, hash(seed, stream))))"):
        for brought in (seed(tree), *map(tree.geometry, ("Incoming", "Parametric", "Position"))):
            noise = tree.node("ShaderNodeTexWhiteNoise", noise_dimensions="4D", Vector=brought, W=w)
            w = Value(tree, output(noise, "Value"))
    tree.output_vector("Random", Value(tree, output(noise, "Color")), tip="Three numbers in 0..1")


def seed(tree: Tree) -> Value:
    """The scene's, and its frame where Cycles counts that too (Animate Seed), as they are when it renders."""
    number, animated, frame = (
        _of_scene(tree, path) for path in ("cycles.seed", "cycles.use_animated_seed", "frame_current")
    )
    return vector(number, animated * frame, 0.0)


def _of_scene(tree: Tree, path: str) -> Value:
    node = tree.node("ShaderNodeAttribute", attribute_type="VIEW_LAYER", attribute_name=path)
    return Value(tree, output(node, "Fac"))


def stream(draw: str, index: int = 0) -> int:
    """The stream of a draw of node groups; index: which of its streams, from 0."""
    return NODE_STREAMS[draw][index]


def osl_header() -> str:
    """The first stream of each draw, as OSL's preprocessor reads it."""
    return "".join(f"#define STREAM_{draw} {streams[0]}\n" for draw, streams in OSL_STREAMS.items())


def random_numbers(tree: Tree, stream: float | Value) -> tuple[Value, Value, Value]:
    """u1, u2, u3 of ``stream``."""
    node = tree.group(ensure(NAME, REVISION, build), Stream=stream)
    return Value(tree, node.outputs["Random"]).xyz
