# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's settings, stored with the scene."""

from __future__ import annotations

import zlib
from collections import Counter
from functools import lru_cache

import bpy

from ..library import families, presets
from ..library.search import nearest
from ..models import estimators
from ..reference.hybrid import BOUNDS, DEFAULT_BOUND
from . import memory, thumbnails

BACKENDS = (
    (
        "nodes",
        "Nodes",
        "Shader nodes, for every device",
        "NODETREE",
        0,
    ),
    ("osl", "OSL", "Open Shading Language: CPU and OptiX only. Switch it on in the render properties", "SCRIPT", 1),
)
QUALITIES = (
    (
        "standard",
        "Standard",
        "Cycles' own closures, fitted to the formula. Fast; stays correct when the scene changes",
        0,
    ),
    (
        "exact",
        "Exact Lights",
        "Direct light from the eight strongest lights follows the formula exactly. Several times slower",
        1,
    ),
    ("reference", "Reference", "The formula without bias, for comparison. Noisy under small lights", 2),
)
STORED = ("auto", "corrected", "mirror")  # the estimator behind each quality
ESTIMATORS = (
    ("auto", "Automatic", "Closure or Fit: the smaller expected error in this scene", 0),
    *((name, of.label, of.tip, of.number) for name, of in estimators.ESTIMATORS.items()),
)

ALL, FAVOURITES, RECENT = "ALL", "FAVOURITES", "RECENT"
FIRST = "metals/copper"
Item = tuple[str, str, str, int, int]
_families: list[Item] = []  # Blender keeps no reference to the texts of a dynamic enum
_shown: list[Item] = []


EXACT = 0xFFFFFF  # Blender's buttons hold the number of a choice as float32


def number(name: str) -> int:
    """What Blender stores in place of a family's name: the same in every file, whatever other families there are."""
    return zlib.crc32(name.encode()) & EXACT


def _places() -> dict[str, int]:
    """The number of each preset; none is stored, as ``shown`` reads and writes the preset's id."""
    return {identity: place for place, identity in enumerate(presets.all_presets())}


def _tip(preset: presets.Preset) -> str:
    numbers = ", ".join(f"{key} {value}" for key, value in preset.parameters.items())
    about = f"{preset.spec.opening}{preset.name.lower()}: {numbers}"
    return f"{about}. Source: {preset.source['data']}. {preset.notes}".strip()


def family_items(_self: object, _context: object) -> list[Item]:
    """All, the user's favourites and recent ones, and each family with its number of presets."""
    counts = _counts(tuple(presets.all_presets()))
    rows = [
        (ALL, "All", "Every preset", "NONE"),
        (FAVOURITES, "Favourites", "Presets with a star", "SOLO_ON"),
        (RECENT, "Recently Used", "Presets you applied last", "TIME"),
    ]
    rows += [(title, f"{title} ({count})", f"Presets of the family {title}", "NONE") for title, count in counts.items()]
    icons = bpy.types.UILayout.bl_rna.functions["prop"].parameters["icon"].enum_items
    _families[:] = [(name, label, tip, icons[icon].value, number(name)) for name, label, tip, icon in rows]
    return _families


@lru_cache(maxsize=2)
def _counts(identities: tuple[str, ...]) -> dict[str, int]:
    """How many presets each family has, those of the user first. Cached: Blender asks for the list at every redraw."""
    counts = Counter(map(families.title, identities))
    own = [title for title in counts if title not in families.TITLES]
    return {title: counts[title] for title in (*sorted(own), *families.TITLES) if counts[title]}


def matching(settings: VGrooveSettings) -> list[presets.Preset]:
    """What the search finds in all families, the best first; without one, the presets of the chosen family."""
    known = presets.all_presets()
    if words := settings.search.strip():
        return [known[identity] for identity in _found(words, tuple(known))[1]]
    family = settings.family  # read once: Blender rebuilds the list of families each time
    if family in {FAVOURITES, RECENT}:
        ids = memory.favourites() if family == FAVOURITES else memory.recent()
        return [known[identity] for identity in ids if identity in known]
    return [known[identity] for identity in _in_family(family, tuple(known))]


# Cached, as Blender asks at every redraw, several times.


@lru_cache(maxsize=2)
def _found(words: str, _identities: tuple[str, ...]) -> tuple[str, list[str]]:
    searched, found = nearest(words, presets.all_presets().values())
    return searched, [preset.id for preset in found]


def searched_words(settings: VGrooveSettings) -> str:
    """The words that count, as no preset may have all of them."""
    return _found(settings.search.strip(), tuple(presets.all_presets()))[0]


@lru_cache(maxsize=2)
def _in_family(family: str, identities: tuple[str, ...]) -> list[str]:
    listed = [one for one in identities if family in {"", ALL, families.title(one)}]
    return sorted(listed, key=lambda one: (families.number(one), one))


def chosen_preset(settings: VGrooveSettings) -> presets.Preset:
    """The panel's preset; the first one where the .blend names one that this installation does not have."""
    known = presets.all_presets()
    return known.get(settings.preset) or known[FIRST]


def shown_items(settings: VGrooveSettings, _context: object) -> list[Item]:
    """The presets found, each with its picture; the chosen one is among them, or none was found."""
    rows, chosen = matching(settings), chosen_preset(settings)
    rows, places = rows if chosen in rows else [chosen, *rows], _places()
    _shown[:] = [(p.id, p.name, _tip(p), thumbnails.icon(p), places[p.id]) for p in rows]
    return _shown


def choose_listed(settings: VGrooveSettings, _context: object = None) -> None:
    """Another family or search: where the chosen preset is not among what it lists, its first one is chosen."""
    listed = matching(settings)
    if listed and chosen_preset(settings) not in listed:
        settings.preset = listed[0].id


def _list_chosen(settings: VGrooveSettings, _context: object) -> None:
    """Another preset, by a script or an operator: where it is not listed, its family is."""
    chosen = chosen_preset(settings)
    if chosen not in matching(settings):
        settings.search = ""
        settings.family = families.title(chosen.id)
        settings.preset = chosen.id  # again: meanwhile the first of a list was chosen


def _get_shown(settings: VGrooveSettings) -> int:
    return _places()[chosen_preset(settings).id]


def _set_shown(settings: VGrooveSettings, value: int) -> None:
    settings.preset = list(presets.all_presets())[value]


def _get_quality(settings: VGrooveSettings) -> int:
    """Estimators that are no quality of their own count as the nearest."""
    known = estimators.ESTIMATORS.get(settings.estimator)  # none for Automatic
    return [name for name, *_ in QUALITIES].index(known.quality) if known else 0


def _set_quality(settings: VGrooveSettings, value: int) -> None:
    settings.estimator = STORED[value]


class VGrooveSettings(bpy.types.PropertyGroup):
    """What Apply applies to the selected objects."""

    preset: bpy.props.StringProperty(
        name="Preset",
        description="The material to apply, by id",
        default=FIRST,
        options={"HIDDEN"},
        update=_list_chosen,
    )
    family: bpy.props.EnumProperty(
        name="Family",
        description="Which presets to list",
        items=family_items,
        default=number(families.TITLES[0]),
        update=choose_listed,
    )
    search: bpy.props.StringProperty(
        name="Search",
        description="Words to find in all families, such as: gold satin",
        options={"TEXTEDIT_UPDATE"},
        update=choose_listed,
    )
    shown: bpy.props.EnumProperty(
        name="Preset", description="The material to apply", items=shown_items, get=_get_shown, set=_set_shown
    )
    backend: bpy.props.EnumProperty(name="Backend", description="Shader nodes or OSL", items=BACKENDS, default="nodes")
    estimator: bpy.props.EnumProperty(
        name="Estimator", description="How Cycles renders the model", items=ESTIMATORS, default="auto"
    )
    keep_textures: bpy.props.BoolProperty(
        name="Keep Textures",
        description="The new material takes the image textures, bump and displacement of the one that it replaces",
        default=True,
    )
    disperses: bpy.props.BoolProperty(
        name="Dispersion",
        description="Colors spread by the material's Abbe number, as in a prism. Blender 5.3 and newer; more noise",
        default=False,
    )
    bounces: bpy.props.BoolProperty(
        name="Multiple Scattering",
        description=(
            "Adds light that bounces more than once between the facets of a rough metal, which gets brighter and its "
            "color deeper. Off: one bounce, as the paper has it. If you make a smooth metal rough, press Update"
        ),
        default=True,
    )
    quality: bpy.props.EnumProperty(
        name="Quality",
        description="How closely the render follows the formula",
        items=QUALITIES,
        get=_get_quality,
        set=_set_quality,
    )
    bound: bpy.props.FloatProperty(
        name="Bound",
        description="Largest error of the reflected light; smaller is noisier",
        default=100.0 * DEFAULT_BOUND,
        min=100.0 * BOUNDS[0],
        max=100.0 * BOUNDS[1],
        subtype="PERCENTAGE",
        precision=1,
    )


CLASSES = (VGrooveSettings,)
