# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewer's formulas, run by V8 as in a browser."""

import json

import numpy as np
from py_mini_racer import MiniRacer

from vgroove.viewer import bundle, content

MANY = """
const REGISTRY = %s;
function many(form, wi, wo) {
  const model = $brdf.brdf(form, REGISTRY.specs, MODELS);
  return JSON.stringify(wi.map((light, k) => model.evaluate(light, wo[k])));
}
"""


class Machine:
    """V8 with the formulas of a script."""

    def __init__(self, script=None):
        self.engine = MiniRacer()
        self.engine.eval((script or bundle.script("brdf")) + MANY % json.dumps(content.registry()))

    def evaluate(self, form, wi, wo):
        """f of pairs (n, 3), (n, 3)."""
        numbers = ",".join(json.dumps(one) for one in (form, wi.tolist(), wo.tolist()))
        return np.array(json.loads(self.engine.eval(f"many({numbers})")))


def directions(rng, count):
    """Evenly over the hemisphere."""
    z, phi = rng.random(count), 2.0 * np.pi * rng.random(count)
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)
