# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files of every format, by a seed: content and the ending that it has."""

import struct

import numpy as np

from vgroove.addon.measured import utia
from vgroove.addon.reference import CookTorrance, Schlick

from .makers import AZIMUTHS, astm_text, rgl_arrays, tensor_file, utia_bytes

f = CookTorrance(0.4, Schlick([0.95, 0.64, 0.54])).evaluate


def cut(content, rng):
    return content[: int(rng.integers(1, len(content)))]


# RGL


def rgl(rng, change=lambda arrays: None, order="<"):
    arrays = rgl_arrays(int(rng.integers(99)), list(AZIMUTHS.values())[int(rng.integers(4))])
    change(arrays)
    return tensor_file(arrays, order)


def set_entry(name, value):
    return lambda arrays: arrays.update({name: np.full_like(arrays[name], value)})


def drop(name):
    return lambda arrays: arrays.pop(name)


def huge(rng):
    """One dimension is gigantic: a size that must not be believed."""
    content = bytearray(rgl(rng))
    at = content.index(b"vndf") + 4 + 3 + 8 + 8 * int(rng.integers(4))
    content[at : at + 8] = struct.pack("<Q", 2 ** int(rng.integers(20, 63)))
    return bytes(content)


RGL = {
    "cut": lambda rng: cut(rgl(rng), rng),
    "swapped": lambda rng: rgl(rng, order=">"),
    "huge": huge,
    "version": lambda rng: rgl(rng).replace(b"\0\1\0", b"\0\7\0", 1),
    "fields": lambda rng: rgl(rng)[:14] + rng.bytes(3) + b"\x7f" + rgl(rng)[18:],
    "type": lambda rng: rgl(rng).replace(b"sigma\2\0\n", b"sigma\2\0\x63"),
    "missing": lambda rng: rgl(rng, drop(("theta_i", "vndf", "sigma", "rgb")[int(rng.integers(4))])),
    "nan": lambda rng: rgl(rng, set_entry(("theta_i", "vndf", "sigma", "ndf")[int(rng.integers(4))], np.nan)),
    "negative": lambda rng: rgl(rng, set_entry(("vndf", "sigma")[int(rng.integers(2))], -1.0)),
    "nothing": lambda rng: rgl(rng, set_entry(("vndf", "theta_i", "sigma")[int(rng.integers(3))], 0.0)),
    "shape": lambda rng: rgl(rng, lambda arrays: arrays.update(vndf=arrays["vndf"][:, 1:])),
    "scalar": lambda rng: rgl(rng, lambda arrays: arrays.update(sigma=arrays["sigma"][:1, :1])),
}

# ASTM


def text(**options):
    return astm_text(f, step=30.0, **options).encode()


def with_line(rng, line):
    """One of the lines of numbers is another."""
    lines = text().split(b"\n")
    lines[int(rng.integers(3, len(lines) - 1))] = line
    return b"\n".join(lines)


ASTM = {
    "cut": lambda rng: cut(text()[:-200], rng),
    "points": lambda rng: text(points=int(rng.integers(109, 10**9))),
    "columns": lambda rng: with_line(rng, b"0,0,0,0,1,1"),
    "letters": lambda rng: with_line(rng, b"0,0,0,0,1,1," + rng.bytes(5).hex().encode() + b"x"),
    "angle": lambda rng: with_line(rng, b"0,0,1e300,0,1,1,1"),
    "names": lambda rng: text().replace(b"phi_s", b"psi"),
    "colours": lambda rng: text().replace(b"R,G,B", b"R,B,G"),
    "negative": lambda rng: astm_text(lambda wi, _: np.full((len(wi), 3), -1.0), step=30.0).encode(),
}

# UTIA

UTIA = {
    "cut": lambda rng: cut(utia_bytes(f), rng),
    "longer": lambda rng: utia_bytes(f) + bytes(int(rng.integers(1, 100))),
    "swapped": lambda rng: np.frombuffer(utia_bytes(f)).byteswap().tobytes(),
    "nan": lambda rng: np.full(utia.SIZE // 8, np.nan).tobytes(),
    "negative": lambda rng: np.full(utia.SIZE // 8, -1.0).tobytes(),
}

# MERL; those of full size are few, as each has 35 MB


def merl(sizes, body=b"", order="<"):
    return struct.pack(f"{order}3i", *sizes) + body


MERL = {
    "header": lambda rng: merl((90, 90, 180))[: int(rng.integers(1, 12))],
    "cut": lambda rng: merl((90, 90, 180), rng.bytes(int(rng.integers(0, 10**5)))),
    "swapped": lambda rng: merl((90, 90, 180), rng.bytes(800), ">"),
    "sizes": lambda rng: merl(rng.integers(1, 400, 3).tolist(), rng.bytes(800)),
    "gigantic": lambda rng: merl((2**31 - 1,) * 3, rng.bytes(800)),
    "signs": lambda rng: merl((-90, 90, -180), rng.bytes(800)),
}
BODY = 8 * 3 * 90 * 90 * 180
WHOLE_MERL = {
    "longer": lambda rng: merl((90, 90, 180), bytes(BODY + 1)),
    "wrong": lambda rng: merl((90, 90, 360), bytes(BODY)),
    "invalid": lambda rng: merl((90, 90, 180), np.full(BODY // 8, -1.0).tobytes()),
}
OTHER = {"nothing": lambda rng: b"", "noise": lambda rng: rng.bytes(int(rng.integers(1, 10**4)))}
# Endings tell damaged files apart: of noise it can only be said what it should have been.
ENDINGS = {".bsdf": RGL, ".astm": ASTM, ".bin": UTIA, ".binary": MERL, ".dat": OTHER}
EACH = 6


def damaged():
    """(ending, kind, seed), 200 and more."""
    found = [(ending, kind, seed) for ending, kinds in ENDINGS.items() for kind in kinds for seed in range(EACH)]
    return found + [(".binary", kind, 0) for kind in WHOLE_MERL]


def content_of(ending, kind, seed):
    return (WHOLE_MERL | ENDINGS[ending])[kind](np.random.default_rng([seed, len(kind)]))
