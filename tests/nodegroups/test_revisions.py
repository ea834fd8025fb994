# SPDX-License-Identifier: GPL-3.0-or-later
"""A node group that changed has a new REVISION: a file's own group is rebuilt only where that differs.

revisions.toml has the revision of every group and a digest of what it holds. After a change, raise the REVISION of each
group that the test names, and of those that hold it; then have the table written:

    pytest tests/nodegroups/test_revisions.py --write
"""

import tomllib
from functools import cache
from hashlib import sha256
from itertools import product
from pathlib import Path

import bpy
import pytest

from vgroove import headless, nodegroups
from vgroove.addon.blender.groups import TABLES
from vgroove.addon.blender.material import BACKENDS, Choice, build, lamps_to_bind
from vgroove.lab.report.findings import DEFAULT
from vgroove.nodegroups import REVISION_KEY, absorption, ramp, versions

from ..models.test_registry import EXAMPLES
from ..scenes import add_light

pytestmark = [pytest.mark.blender, pytest.mark.once]

TABLE = Path(__file__).with_name("revisions.toml")
HEAD = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Written by test_revisions.py: group = [revision, digest]\n\n"
NUMBERED = {"NodeGroupInput", "NodeGroupOutput", "ShaderNodeGroup"}  # nodes whose sockets Blender numbers as they come
PLAIN = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}
COMPILED = {"bytecode", "bytecode_hash"}  # of a script, from its text
SOCKET = ("in_out", "socket_type", "name", "subtype", "min_value", "max_value", "default_value", "hide_value")


def digest(of):
    return sha256(repr(of).encode()).hexdigest()[:12]


def plain(value):
    """Floats by six digits: float32 has seven, and the last depends on who computes them."""
    if isinstance(value, float):
        return f"{value:.6g}"
    return value if isinstance(value, bool | int | str | None) else tuple(map(plain, value))


def key(socket):
    return socket.name if socket.node.bl_idname in NUMBERED else socket.identifier


@cache
def settings_of(kind):
    """Names and types of what a kind of node has beside all nodes' properties."""
    rna = getattr(bpy.types, kind).bl_rna
    return {one.identifier: one.type for one in rna.properties if one.identifier not in rna.base.properties}


def settings(node):
    """What a node is, without label and place; of what it refers to the text, or name and revision."""
    own = settings_of(node.bl_idname)
    found = [(name, plain(getattr(node, name))) for name in own if own[name] in PLAIN and name not in COMPILED]
    if "script" in own:
        found.append(node.script.as_string())
    return found + [(of.name, of[REVISION_KEY]) for name in ("node_tree", "image") if (of := getattr(node, name, None))]


def content(group):
    """Digest of a group's interface and of what its outputs are computed from; nodes and links in any order."""
    sources, known = {link.to_socket: link.from_socket for link in group.links}, {}

    def holds(node):
        if node not in known:
            inputs = [(key(socket), value(socket)) for socket in node.inputs if socket.type != "CUSTOM"]
            known[node] = digest((node.bl_idname, settings(node), inputs))
        return known[node]

    def value(socket):
        if socket in sources:
            return key(sources[socket]), holds(sources[socket].node)
        return plain(getattr(socket, "default_value", None))

    sockets = [one for one in group.interface.items_tree if one.item_type == "SOCKET"]
    interface = [[one.parent.name, *(plain(getattr(one, name, None)) for name in SOCKET)] for one in sockets]
    return digest((interface, [holds(node) for node in group.nodes if node.bl_idname == "NodeGroupOutput"]))


def every_group():
    """The groups of each model by each estimator, backend and kind, in lights of each kind; and those of no model."""
    scene = bpy.context.scene
    for kind, size in product(("SUN", "POINT", "SPOT"), (0.0, 0.2)):
        add_light(scene, kind, kind, size=size)
    for shape in ("SQUARE", "DISK"):
        add_light(scene, shape, "AREA", size=0.2).data.shape = shape
    for preset, backend in product(EXAMPLES, BACKENDS):
        for estimator in preset.spec.estimators:
            lamps = lamps_to_bind(scene, estimator, preset.model)
            for bounces in {False, preset.can_bounce}:
                build(preset, Choice(backend, estimator, lamps, bounces=bounces))
    for color in (False, True):
        ramp.group(color=color)
    nodegroups.ensure(absorption.NAME, absorption.REVISION, absorption.build)
    return bpy.data.node_groups


def test_a_group_that_changed_has_a_new_revision(blender, request):
    """On one Blender, as groups differ between them."""
    if versions.version() != DEFAULT:
        return
    with headless.quiet():
        found = {group.name: [group[REVISION_KEY], content(group)] for group in every_group()}
    for table in TABLES:
        found[table.name] = [table.revision, digest(plain(table.pixels().ravel().tolist()))]
    known = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    changed = sorted(name for name in found.keys() & known.keys() if found[name][1] != known[name][1])
    stale = [name for name in changed if found[name][0] <= known[name][0]]
    assert not stale, f"these changed and files keep their old ones; raise the REVISION of {', '.join(stale)}"
    if request.config.getoption("--write"):
        rows = (f'"{name}" = [{revision}, "{now}"]\n' for name, (revision, now) in sorted(found.items()))
        TABLE.write_text(HEAD + "".join(rows), encoding="utf-8")
    else:
        assert found == known, "run pytest tests/nodegroups/test_revisions.py --write"
