# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets by everyday words: whole words first, then words that begin so. Imports no bpy."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from . import families

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .preset import Preset

WORDS = tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8"))
# Where a word was found: as what the name is about; by what it means; elsewhere in the name, the id or the tags; as the
# start of another.
ABOUT, MEANT, BESIDE, BEGUN = range(4)


@dataclass(frozen=True)
class Entry:
    """The words of a preset: of its name, the one that the name is about ("milk" of "Whole Milk"), and all."""

    name: frozenset[str]
    about: str
    all: frozenset[str]


def search(query: str, presets: Iterable[Preset]) -> list[Preset]:
    """The presets that have every word of ``query``, the best first; all, in their order, where it has none.

    A word is found in the name, the id or the tags of a preset, in any spelling that ``words.toml`` has of
    it, or by another that it has for the same thing. Only where no preset has it so, one that begins with it counts:
    "car" finds paints, not carbides, and "carb" the latter.
    """
    asked = [_singular(word) for word in _words(query)]
    found = list(presets)
    if not asked:
        return found
    ranks = {preset.id: _ranks(asked, preset, whole=True) for preset in found}
    if not any(all(rank is not None for rank in of) for of in ranks.values()):
        ranks = {preset.id: _ranks(asked, preset, whole=False) for preset in found}
    hits = [preset for preset in found if all(rank is not None for rank in ranks[preset.id])]
    return sorted(hits, key=lambda preset: (*_order(asked, preset, ranks[preset.id]), preset.id))


def nearest(query: str, presets: Iterable[Preset]) -> tuple[str, list[Preset]]:
    """What was searched for, and what was found: where no preset has every word, without the first, and so on.

    The last word says what a thing is, those before it how: "old red car" finds cars, if no old ones are there.
    """
    words, known = query.split(), list(presets)
    while len(words) > 1 and not search(" ".join(words), known):
        words.pop(0)
    return " ".join(words), search(" ".join(words), known)


def _order(asked: list[str], preset: Preset, ranks: list[int | None]) -> tuple[bool, int, int, int]:
    """The special families after all; the place of the word found last; how many words more a name has; the family."""
    family = families.number(preset.id)
    more = len(_entry(preset.id, preset.name, preset.tags).name.difference(asked))
    return family >= families.SPECIAL, max(rank or 0 for rank in ranks), more, family


def _ranks(asked: list[str], preset: Preset, *, whole: bool) -> list[int | None]:
    entry = _entry(preset.id, preset.name, preset.tags)
    return [_rank(word, entry, whole=whole) for word in asked]


def _rank(word: str, entry: Entry, *, whole: bool) -> int | None:
    """Where a preset has the word; None if nowhere."""
    if word == entry.about:
        return ABOUT
    if any(phrase <= entry.all for phrase in meanings().get(word, ())):
        return MEANT
    if word in entry.all:
        return BESIDE
    if not whole and any(other.startswith(word) for other in entry.all):
        return BEGUN
    return None


@lru_cache(maxsize=4096)
def _entry(identity: str, name: str, tags: tuple[str, ...]) -> Entry:
    in_name = list(map(_singular, _words(name)))
    about = _words(re.split(r"[,(]", name)[0])  # "Copper, Brushed", "Brass 85-15 (Red Brass)"
    beside = map(_singular, _words(" ".join((identity, *tags))))
    return Entry(frozenset(in_name), _singular(about[-1]) if about else "", frozenset([*in_name, *beside]))


@cache
def meanings() -> dict[str, tuple[frozenset[str], ...]]:
    """What else a word may mean: sets of words, all of which a preset then has."""
    return {
        _singular(_plain(word)): tuple(frozenset(map(_singular, _words(phrase))) for phrase in phrases)
        for word, phrases in WORDS["means"].items()
    }


@cache
def _spellings() -> dict[str, str]:
    """One spelling for all that ``words.toml`` calls the same."""
    return {_plain(word): _plain(same[0]) for same in WORDS["same"] for word in same}


def _words(text: str) -> list[str]:
    return [_spellings().get(word, word) for word in re.findall(r"[^\W_]+", _plain(text))]


def _plain(text: str) -> str:
    """Small letters without accents."""
    return "".join(c for c in unicodedata.normalize("NFKD", text.casefold()) if not unicodedata.combining(c))


def _singular(word: str) -> str:
    """One word for "metals" and "metal", "boxes" and "box", "rubies" and "ruby"; "glass" and "gas" stay."""
    if len(word) <= len("gas") or not word.endswith("s") or word.endswith(("ss", "us")):
        return word
    one = re.sub(r"(?:(?<=x)|(?<=ss|ch|sh))es$|s$", "", re.sub(r"ies$", "ys", word))
    return _spellings().get(one, one)
