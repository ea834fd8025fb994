# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebook as a page; and its cells run, so that what it shows is what the code gives.

python tools/pages/notebook.py docs/tutorial_research.ipynb      run it, and write what it gives into it
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from nbformat import NotebookNode


def run(path: Path) -> NotebookNode:
    """The notebook with what its cells give now, run in its folder; an error if one fails."""
    from nbclient import NotebookClient

    read = nbformat.read(path, as_version=4)
    client = NotebookClient(
        read, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(path.parent)}}
    )
    done = client.execute()
    for cell in done.cells:
        cell.metadata = nbformat.NotebookNode()  # times of this run
        if texts := [one.text for one in cell.get("outputs", ()) if "text" in one]:  # in as many pieces as it came
            others = [one for one in cell.outputs if "text" not in one]
            cell.outputs = [nbformat.v4.new_output("stream", name="stdout", text="".join(texts)), *others]
        for output in cell.get("outputs", ()):
            output.metadata = nbformat.NotebookNode()
    done.metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return done


def as_markdown(path: Path) -> str:
    """Text, code and what it gave: text or a picture."""
    cells = nbformat.read(path, as_version=4).cells
    return "\n\n".join(part for cell in cells for part in _cell(cell)) + "\n"


def _cell(cell: NotebookNode) -> list[str]:
    if cell.cell_type == "markdown":
        return [cell.source]
    return [f"```python\n{cell.source}\n```", *(_output(one) for one in cell.outputs)]


def _output(output: Any) -> str:
    if "text" in output:
        return f"```text\n{output.text.rstrip()}\n```"
    if "image/png" in output.data:
        return f"![What the cell draws](data:image/png;base64,{output.data['image/png'].strip()})"
    return f"```text\n{output.data['text/plain']}\n```"


if __name__ == "__main__":
    book = Path(sys.argv[1])
    nbformat.write(run(book), book)
