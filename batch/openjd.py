# SPDX-License-Identifier: GPL-3.0-or-later
"""A job as an Open Job Description template (2023-09), which studios' farms run. Imports no bpy.

Source: the specification, and its extension TASK_CHUNKING, at github.com/OpenJobDescription/openjd-specifications.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..addon.library.files import check_writable, write_text
from .job import JobError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .job import Task

ENDINGS = (".json", ".yaml", ".yml")  # JSON is YAML too
CHUNK, MOST_CHUNK = 50, 150  # stills that a machine renders in one go: where a farm knows no better; that farms allow
CHUNK_SECONDS = 600  # at which a farm that knows better aims
LONGEST_NAME = 128


def template(job: Path, folder: Path, output: Path, tasks: Sequence[Task], first: int = 1) -> dict[str, Any]:
    """The template of ``tasks``, numbered from ``first``, for a file in ``folder``.

    One step with a range of tasks, of which a machine is given a piece: ``vgroove batch JOB -o DIR --tasks A-B``. The
    files that it reads are parameters, so that farms carry them over and map their paths; those below the folder have
    it as their default.
    """
    scenes = sorted({task.scene for task in tasks if task.digest})
    files = {"Job": str(job.absolute())} | {f"Scene{number}": scene for number, scene in enumerate(scenes, 1)}
    parameters: list[dict[str, Any]] = [
        {"name": name, "type": "PATH", "objectType": "FILE", "dataFlow": "IN"} | _default(path, folder)
        for name, path in files.items()
    ]
    parameters += [
        {"name": "Output", "type": "PATH", "objectType": "DIRECTORY", "dataFlow": "OUT",
         "description": "Where the stills go"} | _default(str(output.absolute()), folder),
        {"name": "Stills", "type": "INT", "default": min(CHUNK, len(tasks)), "minValue": 1, "maxValue": MOST_CHUNK,
         "description": "Rendered in one go by a machine, whose Blender stays open over them"},
        {"name": "Command", "type": "STRING", "default": "vgroove", "description": "Of vgroove on the farm's machines"},
    ]  # fmt: skip
    arguments = ["batch", "{{Param.Job}}", "-o", "{{Param.Output}}", "--tasks", "{{Task.Param.Tasks}}"]
    chunks = {
        "defaultTaskCount": "{{Param.Stills}}", "targetRuntimeSeconds": CHUNK_SECONDS, "rangeConstraint": "CONTIGUOUS",
    }  # fmt: skip
    of_step = {
        "name": "Tasks", "type": "CHUNK[INT]", "range": f"{first}-{first + len(tasks) - 1}", "chunks": chunks,
    }  # fmt: skip
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "extensions": ["TASK_CHUNKING"],
        "name": job.stem[:LONGEST_NAME],
        "parameterDefinitions": parameters,
        "steps": [
            {
                "name": "Render",
                "parameterSpace": {"taskParameterDefinitions": [of_step]},
                "script": {"actions": {"onRun": {"command": "{{Param.Command}}", "args": arguments}}},
            }
        ],
    }


def write(path: Path, job: Path, output: Path, tasks: Sequence[Task], first: int = 1) -> None:
    """``template`` as a file."""
    if path.suffix.lower() not in ENDINGS:
        message = f"{path}: unknown ending {path.suffix!r}; use {' or '.join(ENDINGS)}"
        raise JobError(message)
    check_writable(path)
    for one in (job, output):
        try:
            str(one.absolute()).encode("utf-8")
        except UnicodeEncodeError as error:
            message = f"{one}: is not UTF-8, as a template is; rename it"
            raise JobError(message) from error
    content = template(job, path.absolute().parent, output, tasks, first)
    write_text(path, json.dumps(content, indent=2) + "\n")


def _default(path: str, folder: Path) -> dict[str, str]:
    """Farms take no default that is outside the template's folder."""
    found, folder = (Path(os.path.normpath(one)) for one in (path, folder))
    return {"default": found.relative_to(folder).as_posix()} if found.is_relative_to(folder) else {}
