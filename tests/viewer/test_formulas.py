# SPDX-License-Identifier: GPL-3.0-or-later
"""The page's formulas are those of the NumPy reference, for every model and kind of the registry."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from vgroove.addon.library.preset import Preset
from vgroove.addon.measured import merl
from vgroove.addon.models import MODELS, fresnel
from vgroove.addon.reference.facet_distribution import Term
from vgroove.viewer import bundle, content

_spec = importlib.util.spec_from_file_location("machine_of_viewer", Path(__file__).with_name("machine.py"))
machine = sys.modules["machine_of_viewer"] = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(machine)

PAIRS = 10_000
VIEWS = 20  # of a coupled sum, whose albedo is a quadrature for each
BAR = 1e-5  # of the peak
TERMS = {
    "beckmann": (Term("beckmann", (0.3,)),),
    "ggx": (Term("ggx", (0.1,)),),
    "exponential": (Term("exponential", (0.2,)),),
    "abc": (Term("abc", (1e3, 0.9)), Term("abc", (50.0, 2.0), 0.3)),
    "points": (Term("points", (30.0, 22.0, 6.0, 1.5, 0.3, 0.0)), Term("ggx", (0.2,), 0.5)),
}
FORMULAS = {name: spec for name, spec in MODELS.items() if spec.table is None}  # measured tables are data
TINT = np.array([1.0, 0.8, 0.5])  # so that no two channels are alike


def example(model, kind, *, flags=(), distribution=None, **changes):
    """A preset of a model's default numbers."""
    spec = MODELS[model]
    terms = fresnel.KINDS[kind].parameters if spec.has_fresnel else ()
    own = {one.name: one for one in (*spec.parameters, *terms)}
    own |= {f"{one.name}_{k}": one for one in spec.lobes for k in (1, 2)}
    numbers = {
        name: tuple((TINT * one.default).tolist()) if one.is_rgb and one.name != "f0" else one.default
        for name, one in own.items()
    } | changes
    return Preset("mine/example", "Example", model, kind, numbers, {}, flags=flags,
                  distribution=distribution or spec.distribution)  # fmt: skip


EXAMPLES = {f"{name}-{kind}": example(name, kind) for name, spec in FORMULAS.items() for kind in spec.kinds}
EXAMPLES |= {f"generator-{kind}": example("generator", "dielectric", distribution=of) for kind, of in TERMS.items()}
EXAMPLES |= {
    f"sum-coupled-{m:g}": example("sum", "dielectric", flags=("coupled",), m=m, d=1.0, s=0.7) for m in (0.02, 0.15, 0.6)
}
EXAMPLES["sum-smooth"] = example("sum", "dielectric", flags=("coupled",), m=0.0, d=1.0, s=1.0)
EXAMPLES["anisotropic_sum-coupled"] = example("anisotropic_sum", "dielectric", flags=("coupled",), anisotropy=0.8)
EXAMPLES["cook_torrance-total-reflection"] = example("cook_torrance", "dielectric", eta=0.7)
EXAMPLES["ward-turned"] = example("ward", "bounded", anisotropy=0.9, rotation=0.3)
EXAMPLES["ashikhmin_shirley-turned"] = example("ashikhmin_shirley", "plain", anisotropy=0.9, rotation=0.3)
EXAMPLES["ashikhmin_shirley-lambert"] = example("ashikhmin_shirley", "lambert", amplitude=(0.7, 0.6, 0.5))
EXAMPLES["anisotropic-turned"] = example("anisotropic", "conductor", anisotropy=0.9, rotation=0.3)
HELD = {name: of for name, of in EXAMPLES.items() if not of.spec.flaw(of)}  # no metal as a coat


def errors(preset, script=None):
    """|page - reference| over the reference's peak, at 10,000 pairs of directions."""
    rng = np.random.default_rng(7)
    views = machine.directions(rng, VIEWS if is_coupled(preset) else PAIRS)
    wo = np.repeat(views, PAIRS // len(views), axis=0)
    wi = machine.directions(rng, PAIRS)
    wanted = preset.reference().evaluate(wi, wo)
    found = machine.Machine(script).evaluate(content.form(preset), wi, wo)
    assert found.shape == wanted.shape
    return np.abs(found - wanted) / max(wanted.max(), 1e-300)


def is_coupled(preset):
    return "coupled" in preset.flags or "reflectance" in preset.parameters


@pytest.mark.parametrize("name", HELD)
def test_the_formula_is_the_references(name):
    """To 1e-5 of the peak: the albedo below a coat is interpolated; all else agrees to float64's rounding."""
    preset = HELD[name]
    assert errors(preset).max() < (BAR if is_coupled(preset) else 1e-12)


def test_every_model_of_the_registry_has_a_formula():
    assert set(bundle.models()) == set(FORMULAS)


@pytest.mark.parametrize(
    ("text", "wrong"), [("(4 * wo[2])", "(4.0001 * wo[2])"), ("Math.min(1, (2 * h[2]", "Math.min(1, (2.0001 * h[2]")]
)
def test_an_error_of_a_hundredth_of_a_percent_is_seen(text, wrong):
    """In the denominator, and in G."""
    script = bundle.script("brdf")
    assert text in script
    assert errors(EXAMPLES["cook_torrance-conductor"], script.replace(text, wrong)).max() > BAR


def test_modules_that_import_each_other_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(bundle, "HERE", tmp_path)
    (tmp_path / "a.js").write_text('import { b } from "./b.js";\nexport const a = 1;\n', encoding="utf-8")
    (tmp_path / "b.js").write_text('import { a } from "./a.js";\nexport const b = 1;\n', encoding="utf-8")
    with pytest.raises(ValueError, match=r"a\.js imports itself by way of b\.js"):
        bundle.script("a")


ATOB = """
globalThis.atob = (text) => {
  const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", out = [];
  let bits = 0, count = 0;
  for (const letter of text.replace(/=+$/, "")) {
    bits = ((bits << 6) | letters.indexOf(letter)) & 0xffffff;
    count += 6;
    if (count >= 8) { count -= 8; out.push(String.fromCharCode((bits >> count) & 255)); }
  }
  return out.join("");
};
"""


def test_a_table_gives_its_cells_means_at_their_centres():
    """To a 16-bit float's rounding, 2^-11 of the value."""
    copper = EXAMPLES["cook_torrance-conductor"].reference()
    table = merl.tabulate(copper.evaluate)
    i, j, k = np.random.default_rng(5).integers((0, 1, 0), (50, 20, 36), (200, 3)).T
    theta_h, theta_d, phi_d = ((i + 0.5) / 90) ** 2 * np.pi / 2, (j + 0.5) / 30 * np.pi / 2, (k + 0.5) / 36 * np.pi
    wi, wo = merl.directions(theta_h, theta_d, phi_d)
    lit = (wi[:, 2] > 0.2) & (wo[:, 2] > 0.2)  # where no entry of a cell is below the horizon
    assert lit.sum() > 100
    cells = np.moveaxis(table.reshape(3, 90, 30, 3, 36, 5).mean(axis=(3, 5)), 0, -1)[i, j, k]
    form = {"table": content.table(merl.Merl(table))}
    found = machine.Machine(ATOB + bundle.script("brdf")).evaluate(form, wi[lit], wo[lit])
    np.testing.assert_allclose(found, cells[lit], rtol=2.0**-11, atol=1e-6 * cells.max())
