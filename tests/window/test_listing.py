"""The extension from a repository of its own, by the commands that Blender has for it."""

from ..scripts import load
from ..serving import served

STATE = """
import addon_utils, bpy, sys
print("ON", addon_utils.check("bl_ext.ours.vgroove"), sys.modules["bl_ext.ours.vgroove"].__file__)
print("OPERATOR", bpy.ops.vgroove.apply.idname())
"""


def test_the_listing_is_added_synced_and_installed_from(window, tmp_path):
    """Switched on, in Blender's own folder for that repository, and still on when Blender starts again."""
    listing, package = load("listing"), load("package")
    listing.extensions(tmp_path / "served", package.package(tmp_path / "dist"))
    bare = window.Session("listing")

    def blender(*arguments):
        return bare.blender("with", "--online-mode", *arguments, network=True)

    with served(tmp_path / "served") as (address, asked):
        blender("--command", "extension", "repo-add", "--name", "Ours", "--url", f"{address}/index.json", "ours")
        blender("--command", "extension", "sync")
        blender("--command", "extension", "install", "--enable", "ours.vgroove")
    assert any(path.startswith("/vgroove-") for path in asked)
    said = blender("--background", "--python-expr", STATE)
    assert f"ON (True, True) {bare.place}/with/extensions/ours/vgroove/__init__.py" in said
    assert "OPERATOR VGROOVE_OT_apply" in said
