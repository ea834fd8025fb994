# SPDX-License-Identifier: GPL-3.0-or-later
"""Files in the formats of measured BRDFs, made here: measured ones are not ours to give away."""

import struct

import numpy as np

from vgroove.addon.measured import utia
from vgroove.addon.reference import spherical

CODES = {"u1": 1, "f4": 10}


def directions(count, seed):
    """Pairs of unit vectors (count, 3); the second half of them near each other's mirror direction."""
    rng = np.random.default_rng(seed)
    u = rng.random((2, count, 2))
    a, b = spherical(np.arccos(u[..., 0]), 2.0 * np.pi * u[..., 1])
    near = a * [-1, -1, 1] + 0.1 * rng.normal(size=a.shape)
    near[:, 2] = np.abs(near[:, 2])
    b[count // 2 :] = (near / np.linalg.norm(near, axis=1)[:, None])[count // 2 :]
    return a, b


# RGL


def tensor_file(arrays, order="<"):
    """Bytes of a tensor file, from the format's description."""
    head = 12 + 2 + 4 + sum(2 + len(name) + 3 + 8 * (1 + array.ndim) for name, array in arrays.items())
    fields, bodies = b"", b""
    for name, array in arrays.items():
        fields += struct.pack(f"{order}H", len(name)) + name.encode()
        fields += struct.pack(f"{order}HB", array.ndim, CODES[array.dtype.str[1:]])
        fields += struct.pack(f"{order}{1 + array.ndim}Q", head + len(bodies), *array.shape)
        bodies += array.astype(array.dtype.newbyteorder(order)).tobytes()
    return b"tensor_file\0\1\0" + struct.pack(f"{order}I", len(arrays)) + fields + bodies


def rgl_arrays(seed=1, phi_i=(0.0,), *, spectral=False, jacobian=1):
    """Smooth random fields of a .bsdf; ``phi_i`` of more than two azimuths makes it anisotropic."""
    rng = np.random.default_rng(seed)
    theta_i = np.array([0.0, 0.4, 0.8, 1.2, np.pi / 2], np.float32)
    grid = len(phi_i), len(theta_i)

    def smooth(*shape):
        value = rng.random(shape) + 0.2
        for axis in (-1, -2):
            value = (value + np.roll(value, 1, axis) + np.roll(value, -1, axis)) / 3
        return value.astype(np.float32)

    names = {"wavelengths": np.linspace(380, 780, 9).astype(np.float32)} if spectral else {}
    values = smooth(*grid, 9 if spectral else 3, 8, 8)
    return names | {
        "description": np.frombuffer(b"made for a test", np.uint8),
        "phi_i": np.array(phi_i, np.float32),
        "theta_i": theta_i,
        "sigma": smooth(4, 16),
        "ndf": smooth(8, 16) * np.exp(-4 * np.linspace(0, 1, 16, dtype=np.float32)),
        "vndf": smooth(*grid, 16, 24) * np.exp(-3 * np.linspace(0, 1, 24, dtype=np.float32)),
        "luminance": values.mean(axis=2),
        "spectra" if spectral else "rgb": values,
        "jacobian": np.array([jacobian], np.uint8),
    }


AZIMUTHS = {
    "isotropic": (0.0,),
    "all": tuple(np.linspace(-np.pi, np.pi, 9)),
    "half": tuple(np.linspace(-np.pi, 0.0, 5)),
    "quarter": tuple(np.linspace(-np.pi, -np.pi / 2, 4)),
}

# ASTM


def astm_text(f, *, degrees=False, columns="R,G,B", phi_i=(0.0,), step=15.0, points=None):
    """Text of an ASTM file: f(wi, wo) at polar angles below 90 degrees and azimuths all around."""
    theta, phi = np.radians(np.arange(0.0, 90.0, step)), np.radians(np.arange(0.0, 360.0, step))
    angles = np.stack(np.meshgrid(theta, phi_i, theta, phi, indexing="ij"), -1).reshape(-1, 4)
    values = f(spherical(angles[:, 0], angles[:, 1]), spherical(angles[:, 2], angles[:, 3]))
    shown = np.degrees(angles) if degrees else angles
    lines = [",".join(f"{value:.9g}" for value in row) for row in np.column_stack([shown, values])]
    head = f"SAMPLE_NAME made for a test\nNUM_POINTS {len(lines) if points is None else points}\n"
    return head + f"VARS theta_i,phi_i,theta_s,phi_s,{columns}\n" + "\n".join(lines) + "\n"


# UTIA


def utia_angles():
    """wi and wo (288, 288, 3) of the entries of a channel."""
    theta, phi = np.radians(np.arange(6) * 15.0), np.radians(np.arange(48) * 7.5)
    ring = spherical(*np.meshgrid(theta, phi, indexing="ij")).reshape(-1, 3)
    return np.broadcast_to(ring[:, None], (288, 288, 3)), np.broadcast_to(ring, (288, 288, 3))


def utia_bytes(f):
    """Bytes of a .bin file of f(wi, wo)."""
    content = np.moveaxis(f(*utia_angles()), -1, 0).astype("<f8").tobytes()
    assert len(content) == utia.SIZE
    return content
