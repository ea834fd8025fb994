# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove measure --merl``: any material as a MERL table."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio_merl
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.addon.measured import read, tabulate
from vgroove.nodegroups import versions

from ..commands import patient

pytestmark = pytest.mark.blender

MERL = ("--merl", "-o", "x.binary")


@pytest.fixture
def materials(scene_line, blender):
    """all.blend: Principled without a reflection, copper by Exact Lights, and glass."""
    plain = blender.data.materials.new("Plain")
    (node,) = (one for one in versions.nodes_of(plain).nodes if one.bl_idname == "ShaderNodeBsdfPrincipled")
    node.inputs["Specular IOR Level"].default_value = 0.0
    copper = build(presets.find("lecture/copper"), Choice("nodes", "corrected"))
    copper.name = "Ours"
    transparent = next(one for one in presets.all_presets().values() if one.transparent)
    glass = build(transparent, Choice("nodes", "closure"))
    glass.name = "Glass"
    for one in (plain, copper, glass):
        one.use_fake_user = True
    with headless.quiet():
        blender.ops.wm.save_as_mainfile(filepath=str(scene_line.folder / "all.blend"))
    return scene_line


def near(found, expected, rtol):
    """Entries of two tables, where both directions are over 6 degrees above the horizon: see test_gonio_merl.py."""
    lit = expected[0] >= 0
    assert found.contents.coverage == 1.0
    high = np.stack([np.minimum(wi[..., 2], wo[..., 2]) > 0.1 for wi, wo in gonio_merl.rows(180)]) & lit
    scale = expected[:, high].max()
    np.testing.assert_allclose(found.table[:, high], expected[:, high], rtol=rtol, atol=2e-5 * scale)


def test_blenders_own_material_is_measured_as_it_stands(materials):
    """0.8 / pi of Principled's base color."""
    done = patient("measure", "all.blend", "--material", "Plain", *MERL)
    assert done.code == 0, done.err
    assert "theta_h" in done.err
    found = read(materials.folder / "x.binary")
    near(found, tabulate(lambda wi, _wo: np.full_like(wi, 0.8 / np.pi)), 4e-5)


def test_a_material_of_ours_is_bound_to_the_instruments_sun(materials):
    """By its own estimator: Exact Lights gives the formula."""
    done = patient("measure", "all.blend", "--material", "Ours", *MERL)
    assert done.code == 0, done.err
    near(read(materials.folder / "x.binary"), tabulate(presets.find("lecture/copper").reference().evaluate), 4e-5)


def test_a_measurement_that_stopped_is_resumed(line, monkeypatch):
    """With what was measured before, and not of another; what is left beside the output goes in the end."""
    first = np.full((3, gonio_merl.BAND, 90, 180), 0.25)
    began = []

    def bands(_make, *, first=0, **_options):
        began.append(first)
        for index in range(first, gonio_merl.BANDS):
            if stop and index == 4:
                message = "stopped"
                raise RuntimeError(message)
            yield held + index

    held, stop = first, True
    monkeypatch.setattr(gonio_merl, "bands", bands)
    assert patient("measure", "lecture/copper", *MERL).code == 3
    assert (line.folder / "x.binary.part").is_file()
    stop = False
    assert patient("measure", "lecture/copper", *MERL).code == 0
    assert began == [0, 4]
    assert not (line.folder / "x.binary.part").exists()
    table = read(line.folder / "x.binary").table
    assert table[0, :: gonio_merl.BAND, 0, 0] == pytest.approx(0.25 + np.arange(gonio_merl.BANDS))
    stop = True
    patient("measure", "lecture/copper", *MERL)
    stop = False
    assert patient("measure", "metals/gold", *MERL).code == 0
    assert began[2:] == [0, 0]
    stop = True
    patient("measure", "lecture/copper", *MERL)
    (line.folder / "x.binary.part").write_bytes(b"PK damaged")
    stop = False
    assert patient("measure", "lecture/copper", *MERL).code == 0
    assert began[4:] == [0, 0]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["lecture/copper", "--merl", "-o", "x.exr"], ".binary"),
        (["lecture/copper", *MERL, "--theta-i", 30], "all directions"),
        (["all.blend", "--material", "Plain", "-o", "x.exr", "--theta-i", 30], "--merl"),
        (["all.blend", "--material", "None", *MERL], 'no material "None"; it has "'),
        (["none.blend", "--material", "Plain", *MERL], "none.blend"),
        (["all.blend", "--material", "Plain", *MERL, "--set", "m=0.2"], "as it stands"),
        (["all.blend", "--material", "Glass", *MERL], "lets light through"),
        (["metals_brushed/none", *MERL], "unknown preset"),
    ],
)
def test_wrong_input_ends_with_one_line(materials, arguments, says):
    assert says in materials.refuses("measure", *arguments)


def test_an_anisotropic_preset_is_refused(line):
    """Nothing is written, not even what would be resumed."""
    brushed = next(one.id for one in presets.all_presets().values() if one.model == "anisotropic")
    assert "isotropic surfaces" in line.refuses("measure", brushed, *MERL)
