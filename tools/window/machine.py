# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with a window in a folder: Debian sid's, with a screen in memory. The system itself is left alone.

python tools/window/machine.py

The packages come from the mirror in the system's own apt sources, or from the one in VGROOVE_DEBIAN_MIRROR. What is
there already is not fetched again, and what was interrupted is completed. Needs root and a Debian-like system.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / ".cache" / "window"
SYSTEM = FOLDER / "system"  # the root of Blender's system
MIRROR = "VGROOVE_DEBIAN_MIRROR"
# numpy and requests, without which the extension and Blender's own extension manager do not start, are only
# recommended by the package.
PACKAGES = (
    "blender", "python3-cattr", "python3-numpy", "python3-requests",
    "xvfb", "xauth", "libgl1-mesa-dri", "libegl1", "imagemagick",
)  # fmt: skip
# The archive's date may lie behind a machine's clock; speed before safety, as the folder can be made again.
APT = ("-o", "Acquire::Check-Valid-Until=false", "-o", "Dpkg::Use-Pty=0")
PIXELS = 1600, 1000


class UnavailableError(Exception):
    """This machine cannot have the window; one line says why."""


def mirror() -> str:
    """Of Debian itself, as apt knows it."""
    if named := os.environ.get(MIRROR):
        return named
    asked = ["apt-get", "indextargets", "--format", "$(LABEL) $(REPO_URI)", "Created-By: Packages"]
    for line in _run(asked).stdout.splitlines():
        label, _, address = line.partition(" ")
        if label == "Debian":
            return address
    message = f"apt knows no mirror of Debian; name one in {MIRROR}"
    raise UnavailableError(message)


def set_up() -> Path:
    """The system's root, complete."""
    ready = SYSTEM / "ready"
    if ready.exists() and ready.read_text() == " ".join(PACKAGES):
        return SYSTEM
    if os.geteuid() != 0 or not all(map(shutil.which, ("apt-get", "dpkg-deb", "unshare"))):
        message = "the window tests need root on a Debian system, to set Blender up in a folder of its own"
        raise UnavailableError(message)
    if not SYSTEM.exists():
        _bootstrap()
    _run([*inside("dpkg", "--configure", "-a")])  # what an interrupted run left
    _run([*inside("apt-get", *APT, "update")])
    _run([*inside("apt-get", *APT, "install", "--yes", "--no-install-recommends", *PACKAGES)])
    _run([*inside("apt-get", "clean")])
    ready.write_text(" ".join(PACKAGES))
    return SYSTEM


def _bootstrap() -> None:
    """Debian's smallest system, which appears complete or not at all."""
    part, tool = FOLDER / "part", FOLDER / "debootstrap"
    shutil.rmtree(part, ignore_errors=True)
    tool.mkdir(parents=True, exist_ok=True)
    _run(["apt-get", *APT, "update"])
    _run(["apt-get", *APT, "-o", "APT::Sandbox::User=root", "download", "debootstrap"], folder=tool)
    _run(["dpkg-deb", "--extract", str(max(tool.glob("*.deb"))), str(tool)])
    quick = part / "etc" / "dpkg" / "dpkg.cfg.d" / "quick"
    quick.parent.mkdir(parents=True)
    quick.write_text("force-unsafe-io\npath-exclude=/usr/share/doc/*\npath-exclude=/usr/share/man/*\n")
    script = [str(tool / "usr" / "sbin" / "debootstrap"), "--variant=minbase", "sid", str(part), mirror()]
    _run(["sh", *script], DEBOOTSTRAP_DIR=str(tool / "usr" / "share" / "debootstrap"))
    (part / "etc" / "mtab").unlink(missing_ok=True)
    (part / "etc" / "mtab").symlink_to("/proc/self/mounts")  # Blender asks there which disks there are
    part.rename(SYSTEM)


def inside(*command: str, alone: bool = False, network: bool = False) -> list[str]:
    """A command in Blender's system. Its processes end with it, and so does what is mounted.

    alone: without a network, which keeps other screens away; and without this process's environment, where the bpy
    wheel tells Blender of its own files. apt may need both. network: with this machine's network after all.
    """
    spaces = ["--mount", "--pid", "--fork", "--kill-child", f"--mount-proc={SYSTEM / 'proc'}"]
    settings = ["HOME=/root", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL=C.UTF-8", "DEBIAN_FRONTEND=noninteractive"]
    first = ["sh", "-c", '"$@"; exit $?', "sh"]  # xvfb-run waits for ever if it is a system's first process itself
    return [
        "unshare",
        *spaces,
        *["--net"] * (alone and not network),
        "chroot",
        str(SYSTEM),
        "env",
        *["-i"] * alone,
        *settings,
        *first,
        *command,
    ]


def _run(command: list[str], folder: Path | None = None, **more: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | more,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        check=False,
    )
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines() or ["no reason given"]
        message = f"the window tests cannot set Blender up: {' '.join(command[:2])} failed: {said[-1]}"
        raise UnavailableError(message)
    return done


if __name__ == "__main__":
    try:
        print(set_up())
    except UnavailableError as error:
        sys.exit(f"vgroove: {error}")
