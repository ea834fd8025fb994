# SPDX-License-Identifier: GPL-3.0-or-later
"""What a sample of ``fit`` takes over one of Cycles' own lobes: in turn in one process, a ball fills the picture."""

import time

import numpy as np
import pytest

from vgroove import headless, nodegroups
from vgroove.addon.blender import gonio, material
from vgroove.addon.blender.material import Choice
from vgroove.lab.bench import scenes
from vgroove.lab.check.cook_torrance import materials
from vgroove.nodegroups import cook_torrance_closure, versions

pytestmark = pytest.mark.blender

# Under a softbox little else is to be done than lobes: over one lobe, fit takes 1.21 to 1.34 times as long, by the
# Fresnel term and the machine, and three plain lobes 1.18 to 1.28. There it is held to what its weights cost beside
# these.
MOST = {"environment": 1.2, "softbox": 1.15}
PEER = {"environment": "closure", "softbox": "three lobes"}
ROUNDS, SAMPLES, SIZE = 12, 16, 64


@pytest.mark.parametrize(
    ("scene", "fresnel"),
    [("environment", "schlick"), ("environment", "dielectric"), ("softbox", "schlick"), ("softbox", "conductor")],
)
def test_fit_takes_little_more_than_what_cycles_has(blender, scene, fresnel):
    """At most ``MOST`` times as long as ``PEER``, by the median of rounds, as far as their scatter tells.

    Processor time of one thread, so that what else runs counts little; a render of one sample is taken off, which is
    what has nothing to do with samples. The median of N ratios errs by (pi / 2N)^(1/2) of their scatter: beyond the bar
    by three of these is red. Polynomials in place of the table took 1.4 and 1.7.
    """
    ratio, error = measured(scene, fresnel, "fit")
    assert ratio - 3.0 * error <= MOST[scene], (ratio, error)


def test_the_clock_tells_what_is_slow(blender):
    """``hybrid`` takes about twice as long as three lobes: red."""
    ratio, error = measured("softbox", "schlick", "hybrid")
    assert ratio - 3.0 * error > MOST["softbox"], (ratio, error)


def measured(scene, fresnel, estimator):
    """The median of an estimator's time over that of its peer, and its error."""
    preset = materials()[fresnel].with_parameters(m=0.3)
    with headless.quiet(), scenes.stage(scene, SIZE) as shown:
        shown.scene.render.threads_mode, shown.scene.render.threads = "FIXED", 1
        made = [material.build(preset, Choice("nodes", estimator)), peer(PEER[scene], preset)]
        taken = np.array([[sampled(shown, of) for of in made] for _ in range(ROUNDS + 1)])[1:]  # the first compiles
    ratios = taken[:, 0] / taken[:, 1]
    spread = 1.4826 * np.median(np.abs(ratios - np.median(ratios)))  # as a standard deviation, but for what stands out
    return float(np.median(ratios)), float(spread * np.sqrt(np.pi / 2.0 / ROUNDS))


def peer(name, preset):
    """``closure``, or three of it added up, with a third of the weight each and nothing to compute."""
    if name == "closure":
        return material.build(preset, Choice("nodes", "closure"))

    def build(tree):
        parts = {key: value for key, value in preset.parameters.items() if key != "m"}
        lobes = [
            cook_torrance_closure.lobe(tree, preset.kind, parts, preset.m**0.5, tree.geometry("Normal"))
            for _ in range(3)
        ]
        tree.output_shader("BSDF", tree.add_shaders([tree.weighted(lobe, 1 / 3) for lobe in lobes]), tip="")

    made = versions.empty_material("Three Lobes")
    tree = made.node_tree
    group, output = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeOutputMaterial")
    group.node_tree = nodegroups.make("Three Lobes", 1, build)
    tree.links.new(group.outputs[0], output.inputs["Surface"])
    return made


def sampled(shown, of):
    """Seconds of ``SAMPLES`` samples of a picture."""
    shown.item.active_material = of
    clocks = []
    for samples in (1, 1 + SAMPLES):
        shown.scene.cycles.samples = samples
        start = time.process_time()
        gonio.rendered(shown.scene)
        clocks.append(time.process_time() - start)
    return clocks[1] - clocks[0]
