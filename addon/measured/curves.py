# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers behind plots of BRDFs: along a slice, over an image, over a lobe, and as text in CSV. Needs no Blender.

The light is at theta_i and phi_i. theta_o is positive on the mirror's side of the normal, negative on the light's.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..library.errors import InputError
from ..reference import Smooth, lobe, rendered, spherical
from ..reference.anisotropic import turned
from .merl import directions as pairs_of
from .summary import reflected

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ..reference.directions import Floats
    from ..reference.model import Brdf

MOST = 8  # BRDFs in one figure, as many colours as can be told apart
ALBEDO_ANGLES = np.concatenate([np.arange(0.0, 85.0, 2.5), [85.0, 87.0, 88.0, 89.0]])  # degrees; a quadrature each
CELLS = 90  # of an image, along theta_h and theta_d


@dataclass(frozen=True)
class View:
    """Where the light and the slice are, in degrees, and what f is multiplied by.

    phi_o: azimuth of the slice, from the plane of incidence; 90 is across it.
    theta_h: of a curve over theta_d. phi_d: of curves over theta_h and theta_d, and of the image.
    times: of ``lobe.TIMES``.
    """

    theta_i: float = 45.0
    phi_i: float = 0.0
    phi_o: float = 0.0
    theta_h: float = 0.0
    phi_d: float = 90.0
    times: str = "one"

    @property
    def wi(self) -> Floats:
        return spherical(np.radians(self.theta_i), np.radians(self.phi_i))


@dataclass(frozen=True)
class Numbers:
    """What a plot shows. axes: names of the angles. at: (..., axes), in degrees. rgb: (..., 3) by name.

    quantity, unit: of the values; no unit for shares.
    """

    axes: tuple[str, ...]
    at: Floats
    rgb: dict[str, Floats]
    quantity: str
    unit: str


@dataclass(frozen=True)
class Plotted:
    """A BRDF as plots take it: f(wi, wo), and the directional albedo of directions (n, 3).

    mirrors: whether it also mirrors in a single direction, which no plot of f shows.
    """

    f: Brdf
    albedo: Callable[[Floats], Floats]
    mirrors: bool = False


def plotted(brdf: Any) -> Plotted:
    """A preset, a model of the reference or a measured BRDF, as plots take it.

    Of coupled sums and translucent bodies f has the body's share from three facets, as shaders have it.
    """
    if hasattr(brdf, "contents"):
        return Plotted(brdf.evaluate, lambda wo: np.array([_measured_albedo(brdf.evaluate, one) for one in wo]))
    model = brdf.reference() if hasattr(brdf, "reference") else brdf
    specular = getattr(model, "specular", model)
    mirrors = isinstance(specular, Smooth) or not np.any(getattr(model, "m", 1.0))
    return Plotted(rendered(model, "direct"), model.directional_albedo, mirrors)


def _measured_albedo(f: Brdf, wo: Floats) -> Floats:
    wi, weight = reflected(wo)
    return weight @ f(wi, wo)


def numbers(plot: str, brdfs: Mapping[str, Any], view: View) -> Numbers:
    """The numbers of a plot of ``PLOTS``, of BRDFs by name; InputError for what it cannot show."""
    if not 1 <= len(brdfs) <= MOST:
        message = f"a plot shows 1 to {MOST} BRDFs, got {len(brdfs)}; leave some out"
        raise InputError(message)
    ready = {name: plotted(brdf) for name, brdf in brdfs.items()}
    found = PLOTS[plot](ready, view)
    for name, one in ready.items():
        if one.mirrors and plot != "albedo" and not found.rgb[name].any():
            message = (
                f"{name}: is a smooth mirror, which reflects into one direction: f has no values to plot; "
                f"give it a roughness, as in {name}:m=0.1, or choose --plot albedo"
            )
            raise InputError(message)
    return found


def csv_text(plot: str, shown: Numbers, view: View) -> str:
    """A line on the view, one of names with their units, then one for each direction.

    R, G, B in linear Rec.709, Y their luminance.
    """
    import csv  # here, as Blender imports this file when it starts

    file = io.StringIO()
    angles = ", ".join(f"{name} = {value:g} deg" for name, value in vars(view).items() if name != "times")
    file.write(f"# {plot}: {angles}\n")
    writer = csv.writer(file, lineterminator="\n")
    unit = f" ({shown.unit})" if shown.unit else ""
    heads = [f"{name} {shown.quantity} {channel}{unit}" for name in shown.rgb for channel in "RGBY"]
    writer.writerow([*(f"{axis} (deg)" for axis in shown.axes), *heads])
    values = [np.concatenate([rgb, rgb @ lobe.LUMINANCE[:, None]], axis=-1) for rgb in shown.rgb.values()]
    table = np.concatenate([shown.at, *values], axis=-1).reshape(-1, len(shown.axes) + len(heads))
    writer.writerows([f"{number:.9g}" for number in row] for row in table.tolist())
    return file.getvalue()


def quantity(view: View) -> str:
    """What is plotted, in the field's letters."""
    return {"one": "f", "cos_o": "f cos(theta_o)", "cos_io": "f cos(theta_i) cos(theta_o)"}[view.times]


def _slice(brdfs: Mapping[str, Plotted], view: View) -> Numbers:
    """theta_o from one horizon to the other, denser around the mirror direction and the light's own."""
    theta = lobe.slice_angles(view.wi)
    wo = lobe.slice_directions(theta, view.phi_i + view.phi_o)
    return _evaluated(brdfs, view, ("theta_o",), theta[:, None], view.wi, wo)


def _over_theta_h(brdfs: Mapping[str, Plotted], view: View) -> Numbers:
    """theta_d is theta_i, the angle of light and view where theta_h is 0."""
    theta_h = np.square(np.arange(301) / 300.0) * lobe.LAST
    return _half(brdfs, view, "theta_h", theta_h, theta_h, np.full_like(theta_h, view.theta_i))


def _over_theta_d(brdfs: Mapping[str, Plotted], view: View) -> Numbers:
    theta_d = np.concatenate([np.arange(0.0, 90.0, lobe.STEP), [lobe.LAST]])
    return _half(brdfs, view, "theta_d", theta_d, np.full_like(theta_d, view.theta_h), theta_d)


def _half(brdfs: Mapping[str, Plotted], view: View, axis: str, at: Floats, theta_h: Floats, theta_d: Floats) -> Numbers:
    wi, wo = pairs(theta_h, theta_d, view)
    both = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    return _evaluated(brdfs, view, (axis,), at[both][:, None], wi[both], wo[both])


def _image(brdfs: Mapping[str, Plotted], view: View) -> Numbers:
    """(theta_h, theta_d), at the centres of cells that are narrow where theta_h is small; NaN below the horizon."""
    centres = (np.arange(CELLS) + 0.5) / CELLS
    theta_h, theta_d = np.meshgrid(90.0 * np.square(centres), 90.0 * centres, indexing="ij")
    wi, wo = pairs(theta_h, theta_d, view)
    found = _evaluated(brdfs, view, ("theta_h", "theta_d"), np.stack([theta_h, theta_d], axis=-1), wi, wo)
    below = (wi[..., 2] <= 0) | (wo[..., 2] <= 0)
    for rgb in found.rgb.values():
        rgb[below] = np.nan
    return found


def pairs(theta_h: Floats, theta_d: Floats, view: View) -> tuple[Floats, Floats]:
    """wi and wo (..., 3) at these angles in degrees, the half vector on phi_i's side, as the light of a slice is."""
    both = pairs_of(np.radians(theta_h), np.radians(theta_d), np.radians(np.full_like(theta_h, view.phi_d)))
    wi, wo = (turned(one, -np.radians(view.phi_i)) for one in both)
    return wi, wo


def _albedo(brdfs: Mapping[str, Plotted], view: View) -> Numbers:
    """The share of a uniform white sky that is sent toward theta_o."""
    wo = spherical(np.radians(ALBEDO_ANGLES), np.radians(view.phi_i))
    rgb = {name: one.albedo(wo) for name, one in brdfs.items()}
    return Numbers(("theta_o",), ALBEDO_ANGLES[:, None], rgb, "albedo", "")


def _lobe(brdfs: Mapping[str, Plotted], view: View) -> Numbers:
    """(rings, around) of ``lobe.directions``."""
    wo = lobe.directions(view.wi)
    theta = np.degrees(np.arctan2(np.hypot(wo[..., 0], wo[..., 1]), wo[..., 2]))
    phi = np.degrees(np.arctan2(wo[..., 1], wo[..., 0])) % 360.0
    return _evaluated(brdfs, view, ("theta_o", "phi_o"), np.stack([theta, phi], axis=-1), view.wi, wo)


def _evaluated(
    brdfs: Mapping[str, Plotted], view: View, axes: tuple[str, ...], at: Floats, wi: Floats, wo: Floats
) -> Numbers:
    rgb = {name: lobe.weighted(one.f(wi, wo), wi, wo, view.times) for name, one in brdfs.items()}
    return Numbers(axes, at, rgb, quantity(view), "1/sr")


PLOTS: dict[str, Callable[[Mapping[str, Plotted], View], Numbers]] = {
    "polar": _slice,
    "lobe": _lobe,
    "theta_o": _slice,
    "theta_h": _over_theta_h,
    "theta_d": _over_theta_d,
    "albedo": _albedo,
    "slice": _image,
}
