# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove view``: one file that needs nothing else, or one line that says why there is none."""

import json
import re

import numpy as np
import pytest

from vgroove.addon.library import presets
from vgroove.addon.library.errors import InputError
from vgroove.addon.library.preset import Preset
from vgroove.addon.measured import Merl, tabulate, write_merl
from vgroove.addon.models import MODELS, PARAMETERS
from vgroove.cli import app, run
from vgroove.viewer import bundle, content, page

MOST_BYTES = 1_500_000


def view(*arguments):
    return run(lambda: app(["view", *map(str, arguments)], prog_name="vgroove", standalone_mode=False))


def data(text):
    return json.loads(re.search(r'id="content">(.*?)</script>', text, re.DOTALL)[1])


def test_the_page_is_one_file(tmp_path):
    """Small, without any address, and with the numbers of its presets."""
    path = tmp_path / "page.html"
    assert view("copper", "copper:m=0.15", "-o", path) == 0
    text = path.read_text(encoding="utf-8")
    assert len(text.encode()) < MOST_BYTES
    addresses = set(
        re.findall(r"(?:https?:)?//[\w.-]+\.\w+[^\s\"'`]*", re.sub(r"^\s*//.*", "", text, flags=re.MULTILINE))
    )
    assert addresses <= {"http://www.w3.org/2000/svg"}  # the name of SVG's elements, which nothing fetches
    assert not re.search(r'\b(?:src|href)="(?!data:)', text)
    shown = data(text)
    assert shown["shown"] == 2
    copper = presets.find("copper")
    assert shown["presets"][0]["name"] == "lecture/copper"
    assert shown["presets"][0]["form"]["parameters"] == {"m": 0.3, "f0": list(copper.parameters["f0"])}
    assert shown["presets"][1]["form"]["parameters"]["m"] == 0.15


def test_sliders_have_the_registrys_ranges():
    """Each stop is within the range, from one end to the other, and tips are the registry's."""
    specs = content.registry()["specs"]
    assert specs.keys() == {name for name, spec in MODELS.items() if spec.table is None}
    for spec in specs.values():
        for one in (*spec["parameters"], *spec["lobes"]):
            known = PARAMETERS[one["name"]]
            assert one["tip"]
            assert np.all(np.diff(one["stops"]) >= 0.0)
            assert one["stops"][0] == pytest.approx(known.low, rel=1e-3, abs=1e-9)
            assert one["stops"][-1] == pytest.approx(known.native_high or known.high, rel=1e-3)


def test_a_name_cannot_end_the_data():
    """Nor become markup."""
    text = page.page([("</script><b>", presets.find("copper"))])
    assert text.count("</script>") == 2
    assert "<title>&lt;/script&gt;&lt;b&gt;</title>" in text
    assert data(text)["presets"][0]["name"] == "</script><b>"


def test_a_measured_file_is_a_table(tmp_path):
    """16-bit floats of the cells' means."""
    copper = presets.find("copper").reference()
    write_merl(tmp_path / "chrome.binary", tabulate(copper.evaluate))
    assert view(tmp_path / "chrome.binary", "copper", "-o", tmp_path / "page.html") == 0
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert len(text.encode()) < MOST_BYTES
    shown = data(text)["presets"][0]
    assert shown["name"] == "chrome.binary"
    assert shown["form"]["table"]["size"] == [90, 30, 36]


def test_so_is_a_preset_of_one():
    preset = Preset("mine/table", "Table", "measured", "half", {}, {}, table=MODELS["measured"].table)
    assert content.form(preset)["table"]["size"] == (90, 30, 36)


def test_an_anisotropic_table_is_refused():
    merl = Merl(tabulate(lambda wi, wo: np.ones(wi.shape)))
    object.__setattr__(merl.contents, "isotropic", False)
    with pytest.raises(InputError, match="isotropic measurements alone"):
        content.table(merl)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["coper"], 'did you mean "copper"'),
        (["nowhere.binary"], "nowhere.binary"),
        (["copper"] * 9, "up to 8 BRDFs, got 9"),
    ],
)
def test_bad_input_is_one_line(arguments, says, tmp_path, capsys):
    assert view(*arguments, "-o", tmp_path / "page.html") == 2
    said = capsys.readouterr().err
    assert says in said.replace("\n", "")
    assert not (tmp_path / "page.html").exists()


def test_a_model_without_a_formula_is_refused(monkeypatch):
    monkeypatch.setattr(bundle, "models", lambda: ["oren_nayar"])
    with pytest.raises(InputError, match=r"no formula for the model cook_torrance"):
        page.page([("Copper", presets.find("copper"))])
