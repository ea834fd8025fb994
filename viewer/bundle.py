# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewer's modules as one script, so that a page works from a file and needs no build step.

Modules are plain JavaScript that also runs as it stands. This understands the imports and exports that they use:
``import { a, b } from "./x.js"``, ``export const``, ``export function`` and ``export { a } from "./x.js"``.
"""

from __future__ import annotations

import re
from pathlib import Path

HERE = Path(__file__).parent
IMPORT = re.compile(r'^(import|export) \{([^}]*)\} from "([^"]+)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async )?(?:const|function) (\w+))", re.MULTILINE)


def models() -> list[str]:
    """Names of the models that the viewer has."""
    return sorted(path.stem for path in (HERE / "models").glob("*.js"))


def script(entry: str) -> str:
    """A script that defines MODELS (by name) and ``$entry``, the exports of ``entry``.js, and all that they import."""
    order: list[Path] = []
    for path in [*(HERE / "models" / f"{name}.js" for name in models()), HERE / f"{entry}.js"]:
        _visit(path, order, ())
    listed = ", ".join(f"{name}: {_variable(HERE / 'models' / f'{name}.js')}" for name in models())
    return '"use strict";\n' + "\n".join(map(_wrapped, order)) + f"\nconst MODELS = {{ {listed} }};\n"


def _visit(path: Path, order: list[Path], above: tuple[Path, ...]) -> None:
    if path in above:
        message = f"{path.name} imports itself by way of {above[-1].name}"
        raise ValueError(message)
    if path in order:
        return
    for _, _, target in IMPORT.findall(path.read_text(encoding="utf-8")):
        _visit((path.parent / target).resolve(), order, (*above, path))
    order.append(path)


def _wrapped(path: Path) -> str:
    """The module as a function that is called at once and returns its exports."""
    text = path.read_text(encoding="utf-8")
    exported = EXPORT.findall(text)

    def imported(found: re.Match[str]) -> str:
        names = found[2].strip().rstrip(",")
        if found[1] == "export":
            exported.extend(name.strip() for name in names.split(","))
        return f"const {{ {names.replace(' as ', ': ')} }} = {_variable((path.parent / found[3]).resolve())};\n"

    body = EXPORT.sub("", IMPORT.sub(imported, text))
    return f"const {_variable(path)} = (() => {{\n{body}return {{ {', '.join(exported)} }};\n}})();\n"


def _variable(path: Path) -> str:
    return "$" + "_".join(path.resolve().relative_to(HERE.resolve()).with_suffix("").parts)
