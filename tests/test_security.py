# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stranger's file cannot do: docs/security.md makes each of these claims."""

import json
import re
import subprocess
import sys
from html.parser import HTMLParser

import bpy
import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import images
from vgroove.addon.library import presets
from vgroove.addon.library.errors import InputError
from vgroove.batch import cluster, gallery
from vgroove.batch.outcome import RECORD, Outcome
from vgroove.headless import scene
from vgroove.lab.report import draw
from vgroove.nodegroups import versions
from vgroove.viewer import page

from .commands import patient
from .scripts import ROOT

pytestmark = pytest.mark.blender
HOSTILE = "</title></script><!--<script><img src=x onerror=alert(1)>\"'@SCRIPT@{{ 7*7 }}"


class Page(HTMLParser):
    """Its tags, and which of them hold something that a browser runs."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.handlers, self.addresses = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.handlers += [name for name, _ in attributes if name.startswith("on")]
        self.addresses += [value for name, value in attributes if name in {"src", "href"}]


def check_page(text, scripts):
    """No tag, script, handler or address but ours."""
    found = Page(text)
    assert found.tags.count("script") == scripts
    assert found.handlers == []
    assert all(re.match(r"data:|\./|#", address) for address in found.addresses)
    assert "<img src=x" not in text
    assert "49" not in re.sub(r"base64,[^\"]*|\d{3,}", "", "".join(re.findall(r"<h1.*?</h1>|<title.*?</title>", text)))


# A .blend


@pytest.fixture
def hostile_blend(blender, tmp_path):
    """A scene that tries to write a file by each means that Blender has for it."""
    with headless.quiet():
        stage = scene.preview()
    stage.cycles.shading_system = True
    stage.render.resolution_x = stage.render.resolution_y = 16
    text = bpy.data.texts.new("start.py")
    text.write(f"open({str(tmp_path / 'text')!r}, 'w').close()\n")
    text.use_module = True
    curve = bpy.data.objects["Ball"].driver_add("location", 0)
    curve.driver.expression = f"0 * len(str(open({str(tmp_path / 'driver')!r}, 'w')))"
    made = versions.empty_material("Script")
    code = bpy.data.texts.new("script.osl")
    code.write(f'shader s(output color C = 0) {{ fprintf("{tmp_path}/osl", "x"); C = 1; }}\n')
    node = made.node_tree.nodes.new("ShaderNodeScript")
    node.script = code
    shown = made.node_tree.nodes.new("ShaderNodeEmission")
    if node.outputs:
        made.node_tree.links.new(node.outputs[0], shown.inputs["Color"])
    end = made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(shown.outputs[0], end.inputs["Surface"])
    bpy.data.objects["Floor"].data.materials[0] = made
    add_file_output(stage, tmp_path)
    path = tmp_path / "scene" / "hostile.blend"
    path.parent.mkdir()
    with headless.quiet():
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
    for name in ("text", "driver", "osl"):  # what making it did
        (tmp_path / name).unlink(missing_ok=True)
    return path


def add_file_output(stage, folder):
    """A compositor that writes each render to ``folder`` as well."""
    if versions.since(5, 0):
        tree = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
        if versions.since(5, 3):
            stage.compositor_effects.new("Theft").node_group = tree
        else:
            stage.compositing_node_group = tree
    else:
        stage.use_nodes = True
        tree = stage.node_tree
    layers, output = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeOutputFile")
    if versions.since(5, 0):
        output.directory, output.file_name = str(folder), "stolen"
        output.file_output_items.new("RGBA", "Image")
    else:
        output.base_path = str(folder)
    tree.links.new(layers.outputs[0], output.inputs[0])
    return output


def files(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def test_a_scene_writes_nothing_but_what_was_asked_for(hostile_blend, tmp_path):
    """By a script at its start, a driver, an OSL script or a File Output node, in any command that opens it."""
    before = files(tmp_path)
    said = patient("render", hostile_blend, "--samples", "1", "-o", tmp_path / "still.png")
    assert said.code == 0, said
    assert patient("explain", "copper", "--scene", hostile_blend).code == 0
    assert patient("doctor", hostile_blend).code == 0
    assert files(tmp_path) - before == {"still.png"}


def test_a_file_output_node_would_write(hostile_blend, tmp_path):
    """Where nothing mutes it: so the test above can fail."""
    with headless.quiet():
        stage = scene.open_file(hostile_blend, for_saving=True)
        stage.render.filepath = str(tmp_path / "still.png")
        bpy.ops.render.render(write_still=True, scene=stage.name)
    assert any("still" not in name and "hostile" not in name for name in files(tmp_path))


# Pages


def test_a_gallery_shows_names_as_text(blender, tmp_path):
    """Labels, what rendered it, file names and the folder's own name."""
    folder = tmp_path / "<b>'&"
    folder.mkdir()
    outcome = Outcome(HOSTILE, "rendered", 1.5, samples=8, error=0.1).as_json()
    record = {"labels": {"preset": HOSTILE, HOSTILE: "1"}, "outcome": outcome, "files": {HOSTILE: HOSTILE}}
    record |= {"task": {"scene": HOSTILE}, "versions": {"vgroove": HOSTILE}}
    for name in ("javascript:alert(1)", "x' onerror='alert(1)"):
        images.write(tmp_path / "made.exr", np.full((8, 8, 3), 0.5, np.float32), {RECORD: json.dumps(record)})
        (tmp_path / "made.exr").rename(folder / f"{name}.exr")
    found = gallery.stills(folder)
    assert len(found) == 2
    gallery.write_page(folder / "page.html", folder, found, len(found))
    check_page((folder / "page.html").read_text(encoding="utf-8"), scripts=1)


def test_a_viewers_page_shows_names_as_text():
    """In the title and among the data, where a comment and a tag would end the script before its time."""
    text = page.page([(HOSTILE, presets.find("copper"))])
    check_page(text, scripts=2)
    content = re.search(r'id="content">(.*?)</script>', text, re.DOTALL)[1]
    assert json.loads(content)["presets"][0]["name"] == HOSTILE
    assert "<" not in content


def test_a_report_shows_names_as_text(tmp_path):
    """Machine, scene, material and reasons of a report.json."""
    kept = json.loads((ROOT / "tests" / "data" / "report.json").read_text(encoding="utf-8"))

    def spoiled(value):
        if isinstance(value, dict):
            return {name: spoiled(one) for name, one in value.items()}
        return HOSTILE if value == kept["machine"]["processor"] else value

    assert kept["machine"]["processor"]
    from vgroove.lab.bench import record

    draw.draw(record.structured(spoiled(kept)), tmp_path)
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    check_page(text, scripts=text.count("<script>"))
    assert "&lt;script&gt;" in text


# Clusters


@pytest.mark.parametrize(
    "address", ["tcp://farm:8786", "ws://10.0.0.7:8786", "tcp://[::2]:8786", "tcp://127.0.0.1.org:1"]
)
def test_an_unencrypted_cluster_is_refused(address):
    """Before anything is sent; the line names both ways out."""
    with pytest.raises(InputError, match=r"is not encrypted.*tls://.*--insecure"):
        cluster.connect_client(address)


@pytest.mark.parametrize(
    "address", ["tls://farm:1", "wss://farm:1", "tcp://127.0.0.1:1", "tcp://localhost:1", "tcp://[::1]:1"]
)
def test_an_encrypted_or_own_cluster_is_asked(address, monkeypatch):
    monkeypatch.setattr("distributed.Client", lambda address, **_: address)
    assert cluster.connect_client(address) == address
    assert cluster.connect_client("tcp://farm:1", insecure=True) == "tcp://farm:1"


# Imports

WATCH = """
import importlib, pkgutil, sys
EVENTS = {"socket.connect", "socket.bind", "subprocess.Popen", "os.system", "os.remove", "os.rename", "os.mkdir"}
seen = []
def watch(event, arguments):
    writes = event == "open" and isinstance(arguments[1], str) and set(arguments[1]) & set("wax+")
    if event in EVENTS or writes:
        seen.append((event, str(arguments[0])))
sys.addaudithook(watch)
for room in ("addon.models", "addon.reference", "addon.library", "addon.measured", "viewer", "cli"):
    package = importlib.import_module(f"vgroove.{room}")
    for module in pkgutil.walk_packages(package.__path__, f"vgroove.{room}."):
        importlib.import_module(module.name)
import vgroove.batch.job, vgroove.batch.cluster
assert "bpy" not in sys.modules, "Blender was loaded"
print(seen)
"""


def test_nothing_runs_at_import():
    """No process, no connection, no file written; Blender stays out of what does not need it."""
    environment = {"PYTHONDONTWRITEBYTECODE": "1", "PATH": ""}
    done = subprocess.run([sys.executable, "-c", WATCH], capture_output=True, text=True, check=False, env=environment)
    assert done.stdout == "[]\n", done.stdout + done.stderr
