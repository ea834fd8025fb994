# SPDX-License-Identifier: GPL-3.0-or-later
"""What this process holds in memory and what it may, in bytes."""

from __future__ import annotations

import contextlib
from pathlib import Path

import psutil

_PROCESS = Path("/proc/self")
_GROUP = Path("/sys/fs/cgroup")  # of a container on Linux (version 2)


def reset_peak() -> None:
    """Reset ``peak`` if the system can: on Linux (proc(5), clear_refs)."""
    with contextlib.suppress(OSError):  # elsewhere, and in containers that forbid it
        (_PROCESS / "clear_refs").write_text("5", encoding="ascii")


def peak() -> int:
    """The most that was held since ``reset_peak``, or since the process began where that cannot be had."""
    if _PROCESS.is_dir():
        status = (_PROCESS / "status").read_text(encoding="ascii")
        return 1024 * int(status.partition("VmHWM:")[2].split()[0])
    now = psutil.Process().memory_info()
    return int(getattr(now, "peak_wset", now.rss))


def free() -> int:
    """What the machine has left, or the container that this process runs in."""
    left = int(psutil.virtual_memory().available)
    with contextlib.suppress(OSError, ValueError):  # none, or "max"
        most, now = (int((_GROUP / name).read_text(encoding="ascii")) for name in ("memory.max", "memory.current"))
        left = min(left, max(most - now, 0))
    return left


def held() -> int:
    """Bytes in use now."""
    return int(psutil.Process().memory_info().rss)
