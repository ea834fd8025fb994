# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of models share: names of rows of ``vgroove check``, and one light seen in two ways."""

import numpy as np

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.blender.material import Choice, build, lamps_to_bind


def name(row):
    """The function that measures a row and its arguments, for pytest's ids."""
    numbers = (f"{part:.3g}" if isinstance(part, float) else str(part) for part in row.args)
    return "-".join([row.func.__name__, *numbers, *row.keywords]).replace(" ", "_")


def check_that_mirror_counts_lights_once(preset, setup):
    """Lambert sees a sun of zero size by itself, and the lobe by the formula: together they are ``direct``."""
    geometry, images = gonio.Geometry(35.0, resolution=(8, 8)), []
    for estimator in ("mirror", "direct"):
        with headless.quiet(), gonio.stage((8, 8), samples=4, seed=0, shading_osl=setup.shading_osl) as stage:
            gonio.light(stage, geometry)
            bound = lamps_to_bind(stage, estimator, preset.model)
            gonio._patch(stage, build(preset, Choice(setup.backend, estimator, bound, shadows=False)), geometry)
            gonio._camera(stage, geometry)
            images.append(gonio.rendered(stage))
    np.testing.assert_allclose(*images, rtol=2e-5)  # the bar of ``direct``
