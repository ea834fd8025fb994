# SPDX-License-Identifier: GPL-3.0-or-later
"""Any isotropic material as a MERL table, measured in Cycles: every entry is one pixel.

A sphere has every normal, and a custom camera sends each pixel to the point whose normal, under a sun at +z and seen
along the ray, has the entry's half and difference angles. So no entry is interpolated, and all take one sample each.
Only light that is reflected where it arrives counts: nothing bounces, and nothing casts a shadow.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..library.errors import InputError
from ..measured.merl import INVALID, PHI_D, THETA_D, THETA_H, rows
from ..models import base_name
from ..reference.directions import above
from . import gonio, origin

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Material, Scene, ShaderNodeTree
    from numpy.typing import NDArray

BAND = 10  # theta_h of one render, so that progress shows and a measurement can be resumed
BANDS = THETA_H // BAND
TURN = 77.0  # degrees about the sun's direction, by which a band is measured again
LEANS = (0.9, 0.4, 0.0)  # radians, of the sphere then
CLOSURES = {"ShaderNodeBsdfPrincipled", "ShaderNodeBsdfMetallic", "ShaderNodeBsdfAnisotropic"}  # that have a tangent
SAME = 0.01  # share of its sum that the turned band may differ by


class AnisotropicError(InputError):
    """A material whose reflection depends on the azimuth, or on the place."""


def bands(
    make: Callable[[Scene], Material], *, first: int = 0, samples: int = 1, seed: int = 0, shading_osl: bool = False
) -> Iterator[NDArray[np.float64]]:
    """f in 1/sr of the entries of each band of theta_h, (3, BAND, 90, 180), from band ``first`` on.

    -1 below the horizon. make: the material, given the lit scene. AnisotropicError if a band that is measured turned
    differs.
    """
    with gonio.stage((PHI_D[0], BAND * THETA_D), samples=samples, seed=seed, shading_osl=shading_osl) as scene:
        scene.cycles.max_bounces = 0
        (lamp,) = gonio.light(scene, gonio.Geometry())
        lamp.data.use_shadow = False
        material = make(scene)
        if is_anisotropic(material):  # which turning the sphere does not always show
            message = (
                "the material is anisotropic, and MERL tables are for isotropic surfaces: set its Anisotropic or "
                "Anisotropy to 0, and unlink it"
            )
            raise AnisotropicError(message)
        ball = gonio.sphere(scene, material)
        camera = gonio.camera_of(scene, "merl_camera", first=0.0, phi=0.0)

        def measured(band: int, phi: float = 0.0) -> NDArray[np.float64]:
            camera.cycles_custom["first"], camera.cycles_custom["phi"] = float(BAND * band), phi
            return _as_entries(gonio.rendered(scene), band)

        if first == 0:
            there = measured(BANDS // 2)
            ball.rotation_euler = LEANS  # and with it what turns around the object: Blender's own tangent, coordinates
            _check_isotropic(there, measured(BANDS // 2, TURN))
            ball.rotation_euler = (0.0, 0.0, 0.0)
        for band in range(first, BANDS):
            yield measured(band)


def is_anisotropic(material: Material) -> bool:
    """Whether a material of ours has an anisotropy, or one of Blender's closures has one or is fed with it."""
    record = origin.read(material)
    if record is None:
        return _may_turn(material.node_tree)
    return any(base_name(key) == "anisotropy" and value for key, value in record.preset.parameters.items())


def _may_turn(tree: ShaderNodeTree | None) -> bool:
    for node in tree.nodes if tree else ():
        if _may_turn(getattr(node, "node_tree", None)):
            return True
        if node.bl_idname in CLOSURES and any(
            one.name in {"Anisotropic", "Anisotropy"} and (one.is_linked or one.default_value) for one in node.inputs
        ):
            return True
    return False


def _as_entries(image: NDArray[np.float32], band: int) -> NDArray[np.float64]:
    """The sun's radiance f cos(theta_i) as f. Differences of equal terms (``corrected``) may round to below 0."""
    radiance = np.maximum(image.reshape(BAND, THETA_D, PHI_D[0], 3).astype(np.float64), 0.0)
    found = np.full((3, *radiance.shape[:3]), INVALID)
    for index, (wi, wo) in enumerate(list(rows(PHI_D[0]))[band * BAND : (band + 1) * BAND]):
        lit = above(wi, wo)
        found[:, index, lit] = (radiance[index][lit] / wi[lit][:, 2:]).T
    return found


def _check_isotropic(there: NDArray[np.float64], turned: NDArray[np.float64]) -> None:
    total = float(np.maximum(there, 0.0).sum())
    off = float(np.abs(there - turned).sum()) / total if total else 0.0
    if off > SAME:
        message = (
            f"the material differs by {100.0 * off:.2g} % when it is turned by {TURN:g} degrees; MERL tables are for "
            "isotropic surfaces that are alike everywhere: take out textures and anisotropy, or raise --samples"
        )
        raise AnisotropicError(message)
