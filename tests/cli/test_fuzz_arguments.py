# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad arguments (``fuzz.py`` says what holds): numbers, names, addresses, and any words at all."""

import contextlib
import os
import re
import socket
import threading
import types
import typing

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vgroove import cli
from vgroove.addon.library import inputs

from ..commands import vgroove
from .fuzz import FUZZ, SMALL

pytestmark = pytest.mark.blender


# Numbers

NOT_NUMBERS = [
    "٣", "１２", "²", "1_0", "0x10", "", " 1", "+", "nan", "inf", "-inf", "1e999", "-1e999", "1e", "1,5", "\udcff",
    "9" * 5000,
]  # fmt: skip
NOT_WHOLE = ["2147483648", "-2147483649", "99999999999999999999", "1.0", "1e3"]


def number_options():
    """Every option of every command that is a number, with whether it is a whole one."""
    for command in cli.app.registered_commands:
        hints = typing.get_type_hints(command.callback, include_extras=True)
        for name, hint in hints.items():
            if name == "return" or not hasattr(hint, "__metadata__"):
                continue
            kind = hint.__origin__
            kinds = set(kind.__args__) if isinstance(kind, types.UnionType) else {kind}
            if kinds & {int, float}:
                option = hint.__metadata__[0]
                declared = [one for one in (option.default, *(option.param_decls or ())) if isinstance(one, str)]
                yield (
                    command.name or command.callback.__name__,
                    (declared or [f"--{name.replace('_', '-')}"])[0],
                    int in kinds,
                )


OPTIONS = sorted(number_options())
NEEDED = {
    "render": ["copper", "-o", "a.png"], "measure": ["copper", "-o", "a.exr"], "explain": ["copper"],
    "batch": ["job.toml", "-o", "out"], "plot": ["copper", "-o", "a.svg"],
    "view": ["copper", "-o", "a.html"], "fit": ["a.binary", "-o", "a.toml"],
}  # fmt: skip


def test_options_that_are_numbers_are_found():
    """Else the next test would hold of none."""
    assert {"--samples", "--seed", "--fps", "--bound", "--shutter", "--workers", "--memory", "--timeout"} <= {
        option for _, option, _ in OPTIONS
    }
    assert {command for command, _, _ in OPTIONS} == set(NEEDED)


@pytest.mark.parametrize(("command", "option", "is_whole"), OPTIONS, ids=lambda value: str(value).strip("-"))
def test_numbers_are_ascii_and_in_range(line, command, option, is_whole):
    """By every option that is one; so they are by those to come."""
    for number in [*NOT_NUMBERS, *(NOT_WHOLE if is_whole else [])]:
        said = line.refuses(command, *NEEDED[command], f"{option}={number}")
        assert f"'{option}': must be a" in said


@given(st.text(st.sampled_from("0123456789+-_ .eE٣²x"), max_size=12) | st.integers().map(str) | st.text(max_size=4))
def test_whole_numbers_are_those_of_ascii_digits(text):
    low, high = -5, 2**31 - 1
    if re.fullmatch(r"[+-]?[0-9]+", text) and low <= int(text) <= high and len(text.lstrip("+-")) <= 10:
        assert inputs.whole(text, low, high) == int(text)
    else:
        with pytest.raises(inputs.InputError, match=r"must be a whole number from -5 to 2147483647, got"):
            inputs.whole(text, low, high)


@given(st.floats(allow_nan=False, allow_infinity=False) | st.floats(-1, 1))
def test_numbers_are_read_as_python_writes_them(value):
    assert inputs.real(repr(value)) == value
    with pytest.raises(inputs.InputError, match="from 2 to 3"):
        inputs.real(repr(value / 1e308), 2.0, 3.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--frames", "1-99999999999"], "write FIRST-LAST"),
        (["--frames", "1-1048575"], "Blender's frames are -1048574 to 1048574"),
        (["--frames=-1048575-1"], "Blender's frames are"),
        (["--frames", "١-٣"], "write FIRST-LAST"),
        (["--frames", "1–3"], "write FIRST-LAST"),  # a dash
        (["--frames", ""], "write FIRST-LAST"),
        (["--resolution", "٦٤x٦٤"], "write WIDTHxHEIGHT"),
        (["--resolution", ""], "write WIDTHxHEIGHT"),
        (["--resolution", "64x16385"], "pixels up to 16384"),
        (["--set", "m=٣"], "write NAME=NUMBER"),
        (["--set", "m=1_0"], "write NAME=NUMBER"),
        (["--set", "self=1"], 'unknown key "self"'),
        (["--set", "\udcff=1"], "unknown key"),
        (["--set", "m=1e400"], "write NAME=NUMBER"),
    ],
    ids=ascii,
)
def test_texts_with_numbers_are_refused(line, arguments, message):
    assert message in line.refuses("render", "copper", "-o", "a_##.png", *arguments)


def test_a_part_of_a_batch_is_ascii(line):
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n')
    for part in ("١", "1-١", "1-99999999999", "-1", "", "²", "\udcff"):
        assert "--tasks" in line.refuses("batch", "job.toml", "-o", "out", "--tasks", part)


# Names of objects

NOT_NAMES = ["\udcff=copper", "a\udcff=copper", "=copper", "Floor=", "Floor", "Floor=\udcff", "Floor=" + "x" * 100_000]


@pytest.mark.parametrize("item", NOT_NAMES, ids=lambda item: ascii(item)[:20])
def test_what_no_object_can_be_called_is_refused(scene_line, item):
    scene_line.refuses("render", "bare.blend", "--assign", item, "-o", "a.png")


def test_an_object_gets_one_preset(scene_line):
    given = ["--assign", "Floor=copper", "--assign", "Floor=gold"]
    said = scene_line.refuses("render", "bare.blend", *given, "-o", "a.png")
    assert 'gives "Floor" a second preset' in said


@pytest.mark.parametrize(
    ("item", "name", "preset"),
    [
        ("Floor=copper", "Floor", "lecture/copper"),
        ("Floor:2=copper", "Floor:2", "lecture/copper"),
        ("Floor:Trim=metals/gold", "Floor:Trim", "metals/gold"),
        ("Grün=1:x=copper", "Grün=1:x", "lecture/copper"),
        ("a=b:c=d:1=copper", "a=b:c=d:1", "lecture/copper"),
    ],
)
def test_the_last_equals_sign_divides_an_assignment(item, name, preset):
    """No preset's id has one, and names of objects may. ``assign`` decides which part is a slot."""
    ((found, of),) = cli.render.assignments([item])
    assert (found, of.id) == (name, preset)


def test_names_are_utf8_whatever_the_locale_is(scene_line):
    """In an ASCII locale Python keeps the bytes as lone surrogates."""
    assert inputs.name("Grün") == inputs.name(os.fsdecode("Grün".encode())) == "Grün"
    said = vgroove("render", "bare.blend", "--assign", "Grün=1:x=copper", "-o", "a.png", *SMALL)
    assert said.code == 0, said.err


# Terminals


def test_an_ascii_terminal_shows_everything(line):
    for arguments in (["presets"], ["presets", "--json"], ["--help"], ["explain", "copper"]):
        said = vgroove(*arguments, encoding="ascii")
        assert said.code == 0, said
    said = vgroove("render", "\udcff\u202e\x1b[31m", "-o", "Grün.gif", encoding="ascii")
    assert said.code == 2
    assert len(said.lines) == 1
    assert "\x1b" not in said.err


def test_a_line_stays_one_line(line):
    """Whatever names hold, and however long they are."""
    for name in ("a\nb.gif", "a\x1b[31mb.gif", "\u2028.gif", "x" * 100_000 + ".gif"):
        assert len(line.refuses("render", "copper", "-o", name)) <= 1100


# Clusters


@pytest.fixture
def ports():
    """One at which nobody listens, one that says nothing, and one that is another kind of server."""
    silent, chatty, closed = (socket.socket() for _ in range(3))
    for one in (silent, chatty, closed):
        one.bind(("127.0.0.1", 0))
    found = {"closed": closed.getsockname()[1], "silent": silent.getsockname()[1], "ssh": chatty.getsockname()[1]}
    silent.listen()
    chatty.listen()
    closed.close()

    def greet():
        with contextlib.suppress(OSError):
            while True:
                with chatty.accept()[0] as one:
                    one.sendall(b"SSH-2.0-OpenSSH_9.6\r\n")
                    one.recv(1)

    threading.Thread(target=greet, daemon=True).start()
    yield found
    for one in (silent, chatty):
        one.close()


@pytest.mark.parametrize("scheme", ["tcp", "tls", "ws"])
@pytest.mark.parametrize("port", ["closed", "silent", "ssh"])
def test_a_cluster_that_does_not_answer_is_one_line(line, ports, monkeypatch, scheme, port):
    from vgroove.batch import cluster

    monkeypatch.setattr(cluster, "PATIENCE", 1)
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n')
    address = f"{scheme}://127.0.0.1:{ports[port]}"
    said = line.refuses("batch", "job.toml", "-o", "out", "--cluster", address)
    assert f"{address}: no Dask scheduler answers there" in said


@pytest.mark.parametrize(
    "address",
    ["", "farm", "http://farm:1", "ucx://farm:1", "inproc://farm:1", "tcp://farm", "tcp://farm:0", "tcp://farm:65536",
     "tcp://farm:٣", "tcp://a b:1", "tcp://\udcff:x", "javascript:1", "tcp://:1/"],
    ids=ascii,
)  # fmt: skip
def test_what_is_no_address_is_refused(line, address):
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n')
    said = line.refuses("batch", "job.toml", "-o", "out", "--cluster", address)
    assert "write the address of a Dask scheduler, as in tcp://farm:8786" in said


# Any words at all

anything = st.text(st.characters(exclude_characters="\0"), max_size=12) | st.sampled_from(
    [
        "copper",
        "render",
        "-o",
        "--help",
        "--",
        "-",
        "a.png",
        "--frames",
        "1-3",
        "--set",
        "m=1",
        "\udcff",
        "//",
        "{",
        "=",
    ]
)


@FUZZ
@given(
    st.sampled_from(["render", "measure", "explain", "batch", "gallery", "report", "presets", "plot"]),
    st.lists(anything, max_size=5),
)
def test_any_words_are_understood_or_refused_in_one_line(line, command, words):
    """What would be right is cut short by an output that cannot be written."""
    (line.folder / "no").write_text("")
    before = line.files()
    more = [] if command in {"presets", "explain", "report"} else ["-o", "no/a.exr"]
    said = vgroove(command, *words, *more)
    assert said.code in {0, 2}, said
    if said.code == 2:
        assert len(said.lines) == 1, said.err
    assert line.files() == before
