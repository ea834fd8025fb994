# SPDX-License-Identifier: GPL-3.0-or-later
"""What became of a task. Imports no bpy."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from typing import Any

LONGEST_RECORD = 10_000_000  # characters
RECORD = "vgroove"  # attribute of a picture: its outcome, what it shows and what rendered it, as JSON


@dataclass(frozen=True)
class Outcome:
    """What became of a task.

    status: "rendered"; "there", from an earlier time, of which the numbers then are; "failed", for a reason;
    "stumbled", which another try may fix. seconds: until it was rendered, and within Blender's render operator.
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
    """The record in a picture, with its outcome as ``Outcome``; None if there is none or it is damaged."""
    try:
        record: Any = json.loads(text) if len(text) <= LONGEST_RECORD else None
        outcome = Outcome(**record["outcome"])
        tables = [record[key] for key in ("labels", "files", "task", "versions")]
    except (TypeError, ValueError, KeyError, RecursionError):
        return None
    if not all(isinstance(one, dict) for one in tables) or not _holds(outcome):
        return None
    if not all(isinstance(word, str) for table in tables[:2] for word in table.values()):
        return None
    error = float("nan") if outcome.error is None else outcome.error
    return {**record, "outcome": replace(outcome, error=error)}


def _holds(outcome: Outcome) -> bool:
    """Whether the values read from a picture are of the kinds that they must be."""
    words = outcome.name, outcome.status, outcome.reason
    counts = outcome.samples, outcome.memory, outcome.tries
    times = outcome.seconds, outcome.render_seconds, *(() if outcome.error is None else (outcome.error,))
    return (
        all(isinstance(one, str) for one in words)
        and all(type(one) is int and 0 <= one < 2**63 for one in counts)
        and all(type(one) in {int, float} and 0 <= one < math.inf for one in times)
    )
