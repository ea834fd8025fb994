# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba's `measured` at pairs of directions, in a process of its own.

python tests/measured/mitsuba_values.py FILE.bsdf PAIRS.npy VALUES.npy
"""

import sys

import mitsuba
import numpy as np


def main(name, pairs, values):
    mitsuba.set_variant("scalar_rgb")
    bsdf, context = mitsuba.load_dict({"type": "measured", "filename": name}), mitsuba.BSDFContext()
    at, found = mitsuba.SurfaceInteraction3f(), []
    for wi, wo in np.load(pairs).astype(np.float32).tolist():
        at.wi = mitsuba.Vector3f(*wi)
        found.append(np.array(bsdf.eval(context, at, mitsuba.Vector3f(*wo))).ravel())
    np.save(values, found)


if __name__ == "__main__":
    main(*sys.argv[1:])
