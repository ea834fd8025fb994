# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands render a file in its working space, and the light is that of the same scene in a Rec.709 file."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import colour_space, gonio, images
from vgroove.headless import scene
from vgroove.nodegroups import versions

from ..blender.test_colour_space import REC709, switch
from ..commands import vgroove

pytestmark = pytest.mark.blender

SAMPLES = 64
JOB = '[[render]]\nscene = "furnace.blend"\nobject = "Ball"\npreset = "copper"\n'


def save_furnace(bpy, folder, space):
    """furnace.blend, a ball that fills a picture below a white sky, in this working space; returns its matrix."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with gonio.stage((16, 16), samples=SAMPLES, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        ball = bpy.data.objects.new("Ball", scene.ball_mesh())
        ball.data.materials.append(None)
        stage.collection.objects.link(ball)
        gonio.look_down(stage, 1.2, (0.0, 0.0, 9.0))
        bpy.context.window.scene = stage
        switch(space)
        folder.mkdir()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "furnace.blend"), copy=True)
        return colour_space.matrix()


def test_a_furnace_is_the_same_by_render_and_batch(blender, tmp_path):
    """Copper as `vgroove render` and `vgroove batch` have it in ACEScg and in Rec.709, back in Rec.709."""
    if not versions.since(5, 0):  # which has no other space than Rec.709
        return
    found = {}
    for space in (REC709, "ACEScg"):
        folder = tmp_path / space
        with headless.quiet():
            M = save_furnace(blender, folder, space)
        still = vgroove("render", folder / "furnace.blend", "--assign", "Ball=copper", "-o", folder / "still.exr")
        assert still.code == 0, still.err
        (folder / "job.toml").write_text(JOB, encoding="utf-8")
        batch = vgroove("batch", folder / "job.toml", "-o", folder / "out", "--workers", 1, longest=120)
        assert batch.code == 0, batch.err
        for command, path in ("render", folder / "still.exr"), ("batch", *folder.glob("out/*.exr")):
            with images.open_image(path) as file:
                assert file.spec().getattribute("oiio:ColorSpace").startswith(colour_space.name())
                found[space, command] = np.asarray(file.read_image("float"), np.float64), M
    expected, _ = found[REC709, "render"]
    assert expected.shape == (16, 16, 3)
    assert (expected > 0.5).all()
    for (space, command), (picture, M) in found.items():
        back = np.linalg.inv(M)
        # The same samples, whose F by Schlick is linear in F0: only sums of float32 differ, each by at most half of
        # 2^-24 a sample, that of two pictures, and one of them as M^-1 enlarges it.
        rounding = SAMPLES * 2.0**-25 * (1.0 + np.abs(back).sum(axis=1).max())
        np.testing.assert_allclose(picture @ back.T, expected, atol=rounding, err_msg=f"{space} {command}")
        assert (np.abs(picture - expected).max() > 0.05) == (space != REC709)
