# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a batch holds every still once, as text and picture, and nothing from elsewhere."""

import json
import math
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from vgroove.addon.blender import images
from vgroove.batch import gallery
from vgroove.batch.outcome import RECORD, Outcome

pytestmark = pytest.mark.blender


class Page(HTMLParser):
    """Its tags with their attributes, and its text."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.text = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_data(self, data):
        self.text.append(data)

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


def put(folder, name, labels, endings=("exr",), error=0.25):
    outcome = Outcome(name, "rendered", 1.5, samples=8, error=error).as_json()
    record = {"labels": labels, "outcome": outcome, "files": {}}
    record |= {"task": {"scene": "preview"}, "versions": {"vgroove": "test"}}
    for ending in endings:
        picture = np.full((20, 30, 3), 0.5, np.float32)
        images.write(folder / f"{name}.{ending}", picture, {RECORD: json.dumps(record)})


@pytest.fixture
def folder(blender, tmp_path):
    put(tmp_path, "a" * 32, {"preset": "copper", "m": "0.1"}, ("exr", "png"))
    put(tmp_path, "b" * 32, {"preset": "<script>alert(1)</script>", "m": "0.02"}, error=math.nan)
    put(tmp_path, "c" * 32, {"preset": "copper", "m": "10"})
    images.write(tmp_path / "mine.png", np.zeros((4, 4, 3), np.float32), {})
    (tmp_path / "broken.exr").write_bytes(b"x")
    images.write(tmp_path / "record.exr", np.zeros((4, 4, 3), np.float32), {RECORD: '{"outcome": 1'})
    return tmp_path


def test_every_still_is_there_once(folder):
    """In the order of its labels, numbers by size; files of others are not."""
    found = gallery.stills(folder)
    assert [record["labels"]["m"] for record in found] == ["0.02", "0.1", "10"]
    assert found[1]["pictures"] == {".exr": "a" * 32 + ".exr", ".png": "a" * 32 + ".png"}
    assert gallery.filters(found) == {"preset": ["<script>alert(1)</script>", "copper"], "m": ["0.02", "0.1", "10"]}
    gallery.write_page(folder / "page.html", folder, found, len(found))
    text = (folder / "page.html").read_text(encoding="utf-8")
    page = Page(text)
    cards = [json.loads(card["data-labels"]) for card in page.all("article")]
    assert cards == [record["labels"] for record in found]
    assert [one.get("data-name") for one in page.all("select")] == ["preset", "m", None]
    assert len(page.all("script")) == 1
    assert "25.00%" in text
    assert not re.search(r"(src|href)=.https?:", text)
    assert not re.search(r"\{[{%]|nan", "".join(page.text))


def test_thumbnails_look_like_the_pictures(folder, tmp_path):
    """Half the light is sRGB's 0.735 of what is linear, and 0.5 of a PNG, which is as it looks; WebP loses a little."""
    import base64

    found = gallery.stills(folder)
    gallery.write_page(folder / "page.html", folder, found, len(found))
    pictures = [image["src"] for image in Page((folder / "page.html").read_text(encoding="utf-8")).all("img")]
    for source, look in zip(pictures, (0.735, 0.5, 0.735), strict=True):
        (tmp_path / "thumbnail.webp").write_bytes(base64.b64decode(source.partition(",")[2]))
        picture = images.load(tmp_path / "thumbnail.webp")
        assert picture.shape == (128, gallery.WIDTH, 3)
        np.testing.assert_allclose(picture, look, atol=0.02)


def test_links_lead_back_from_elsewhere(folder, tmp_path_factory):
    """A page beside the stills points to their names, one elsewhere to where they are."""
    found = gallery.stills(folder)
    elsewhere = tmp_path_factory.mktemp("page") / "page.html"
    for path, start in ((folder / "page.html", "./"), (elsewhere, folder.as_uri() + "/")):
        gallery.write_page(path, folder, found, len(found))
        links = [one["href"] for one in Page(path.read_text(encoding="utf-8")).all("a")]
        assert start + "a" * 32 + ".png" in links
