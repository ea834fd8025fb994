# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of a task. Imports no bpy."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from typing import Any

RECORD = "vgroove"  # attribute of a picture: its outcome, what it shows and what rendered it, as JSON


@dataclass(frozen=True)
class Outcome:
    """What became of a task.

    status: "rendered"; "there", from an earlier time, of which the numbers then are; "failed", for a reason;
    "stumbled", which another try may mend. seconds: until it was rendered, and within Blender's render operator.
    error: of noise, relative (``mean.Mean.error``), nan where it is not known. memory: bytes, the most that was held.
    reason: why it failed, or what is to be known of it.
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

    def as_json(self) -> dict[str, Any]:
        """As JSON has it: an error that is not known is null."""
        return asdict(self) | {"error": self.error if math.isfinite(self.error) else None}


def read_record(text: Any) -> dict[str, Any] | None:
    """The record of a picture, with its outcome as ``Outcome``; None of what is none, or damaged."""
    try:
        record = json.loads(text)
        outcome = Outcome(**record["outcome"])
        labels, files = dict(record["labels"]), dict(record["files"])
    except (TypeError, ValueError, KeyError):
        return None
    error = float("nan") if outcome.error is None else outcome.error
    return record | {"outcome": replace(outcome, error=error), "labels": labels, "files": files}
