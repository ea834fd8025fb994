# SPDX-License-Identifier: GPL-3.0-or-later
"""Docstrings as they stand: they hold equations and shapes, which Markdown would read as emphasis and footnotes."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING, Any

import griffe

if TYPE_CHECKING:
    from griffe import Object


class Verbatim(griffe.Extension):
    def on_object(self, *, obj: Object, **_: Any) -> None:
        if obj.docstring:
            first, _, rest = obj.docstring.value.replace("``", "`").partition("\n\n")
            pieces = re.split(r"(`[^`]*`)", first)  # code stays as it is
            pieces[::2] = [re.sub(r"([\\*_\[\]])", r"\\\1", escape(piece, quote=False)) for piece in pieces[::2]]
            more = f"\n\n```text\n{rest.strip()}\n```" if rest.strip() else ""
            obj.docstring.value = "".join(pieces) + more
