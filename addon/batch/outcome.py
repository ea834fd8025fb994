# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of a task. Imports no bpy."""

from __future__ import annotations

from dataclasses import dataclass

RECORD = "vgroove"  # attribute of a picture: its outcome, what it shows and what rendered it, as JSON


@dataclass(frozen=True)
class Outcome:
    """What became of a task.

    status: "rendered"; "there", from an earlier time, of which the numbers then are; "failed", for a reason;
    "stumbled", which another try may mend. seconds: until it was rendered, and within Blender's render operator.
    error: of noise, relative (``mean.Mean.error``), nan where it is not known. memory: bytes, the most that was held.
    """

    name: str
    status: str
    seconds: float = 0.0
    render_seconds: float = 0.0
    samples: int = 0
    error: float = float("nan")
    memory: int = 0
    reason: str = ""
    tries: int = 1
