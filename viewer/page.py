# SPDX-License-Identifier: GPL-3.0-or-later
"""One interactive page of BRDFs, as a file that needs no network and no other file."""

from __future__ import annotations

import html
import json
import re
from typing import TYPE_CHECKING, Any

from ..addon.library.preset import Preset
from ..addon.models import MODELS, fresnel
from . import bundle, content

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..addon.measured import Table
    from ..addon.models import Model

MOST = 8  # BRDFs that a page shows at once; as in state.js


def page(brdfs: Sequence[tuple[str, Preset | Table]]) -> str:
    """The page that shows named presets and measured BRDFs, at most ``MOST``. InputError for what it cannot draw.

    >>> from vgroove.addon.library import presets
    >>> page([("Copper", presets.find("copper"))]).startswith("<!doctype html>")
    True
    """
    shown = [{"name": name, "form": _form(of)} for name, of in brdfs]
    others = [{"name": f"{spec.label}, default", "form": _default(spec)} for spec in MODELS.values() if _has(spec)]
    data = {"registry": content.registry(), "presets": shown + others, "shown": len(shown)}
    parts = {
        "@TITLE@": html.escape(", ".join(name for name, _ in brdfs)),
        "@STYLE@": (bundle.HERE / "style.css").read_text(encoding="utf-8"),
        "@SCRIPT@": bundle.script("page"),
        "@CONTENT@": json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c"),  # of any tag
    }
    text = (bundle.HERE / "page.html").read_text(encoding="utf-8")
    return re.sub("|".join(parts), lambda found: parts[found[0]], text)  # at once, as a name may hold such a mark


def _form(of: Preset | Table) -> dict[str, Any]:
    return content.form(of) if isinstance(of, Preset) else {"table": content.table(of)}


def _has(spec: Model) -> bool:
    return spec.name in bundle.models()


def _default(spec: Model) -> dict[str, Any]:
    """A model with the numbers of its sockets, of several lobes one."""
    kind = next(iter(spec.kinds))
    terms = fresnel.KINDS[kind].parameters if spec.has_fresnel else ()
    numbers = {one.name: one.default for one in (*spec.parameters, *terms)}
    numbers |= {f"{one.name}_1": one.default for one in spec.lobes}
    distribution = [content.term(one) for one in spec.distribution]
    return {"model": spec.name, "kind": kind, "flags": [], "parameters": numbers, "distribution": distribution}
