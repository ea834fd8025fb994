# SPDX-License-Identifier: GPL-3.0-or-later
"""Search by everyday words, and the families that artists choose from."""

import time

import pytest

from vgroove.addon.library import families, presets
from vgroove.addon.library.search import WORDS, nearest, search

# What somebody types, and what has to come first: an id, or the beginning of one.
FIRST = """
gold metals/gold; silver metals/silver; copper metals/copper; iron metals/iron; steel alloys/stainless_steel
aluminium metals/aluminium; aluminum metals/aluminium; alu metals/aluminium; chrome metals/chromium; brass alloys/brass
bronze finished_metals/aged_bronze; titanium metals/titanium; tin finished_metals/pewter; pewter finished_metals/pewter
mirror finished_metals/; ring finished_metals/; foil finished_metals/aluminium_foil; rust time_varying/rusting_iron
patina time_varying/copper_patina; corroded time_varying/; anodised finished_metals/anodised; old paper/parchment
galvanised finished_metals/galvanised_steel; "brushed copper" finished_metals/copper_brushed; knife finished_metals/
"polished gold" finished_metals/gold_polished; cast finished_metals/cast_iron; mercury metals/mercury
car car_paints/; "red car" car_paints/; "black car paint" car_paints/black
paint paints/; wall diffuse/; lacquer paints/; "car paint" car_paints/; gloss paints/
"red paint" paints/red_paint; "matte black" paints/black_paint_matte; chalkboard paints/chalkboard; piano paints/
plastic plastics/; "red plastic" plastics/red_plastic; acrylic plastics/pmma; plexiglass plastics/pmma
perspex plastics/pmma; lego plastics/abs; toy plastics/abs
teflon plastics/ptfe; vinyl plastics/pvc; nylon plastics/nylon
rubber rubber/; tyre rubber/tyre_rubber; tire rubber/tyre_rubber; latex rubber/natural_latex; eraser rubber/eraser
glass glasses/glass; window glasses/; frosted glasses/frosted_glass; lens glasses/
bottle glasses/; crystal glasses/; "milk glass" organic/milk_glass; "gray glass" glasses/; "blue glass" glasses/cobalt
water liquids/water; ocean liquids/water
oil liquids/; milk translucent/; honey liquids/honey; blood liquids/blood; alcohol liquids/ethanol
petrol liquids/gasoline
gasoline liquids/gasoline; diamond gems/diamond; ruby gems/ruby; sapphire gems/sapphire; emerald gems/emerald
amethyst gems/amethyst; citrine gems/citrine; garnet gems/; wine liquids/; beer liquids/beer; tea liquids/tea
coffee liquids/coffee; whiskey liquids/whisky; juice liquids/; cola liquids/cola; ink liquids/blue_ink
topaz gems/topaz; opal gems/opal; pearl gems/moonstone; jade organic/jade; amber gems/amber
stone stone/; rock stone/; marble translucent/marble; granite stone/; slate stone/slate; sandstone stone/sandstone
brick diffuse/brick; concrete diffuse/concrete; cement diffuse/concrete; asphalt stone/asphalt; road stone/
snow stone/snow; gravel stone/gravel; sand diffuse/sand; desert stone/desert_sand
mud stone/mud; dirt diffuse/soil; clay diffuse/clay
plaster diffuse/plaster; chalk diffuse/chalk; ice crystals/ice; moon diffuse/moon_dust; wood wood/; oak wood/oak
walnut wood/walnut; bamboo wood/bamboo; parquet wood/; cork wood/cork; bark wood/bark; pine wood/pine
porcelain ceramics/porcelain; tile ceramics/; cup ceramics/; vase ceramics/; enamel ceramics/; bathroom ceramics/
terracotta diffuse/terracotta; leather leather/; suede leather/; "black leather" leather/black_leather; sofa leather/
denim cloth/; jeans cloth/; cotton cloth/; wool cloth/; linen cloth/linen; velvet cloth/; carpet cloth/; silk cloth/
shirt cloth/; towel cloth/towel; felt diffuse/felt; skin translucent/skin; wax organic/; candle organic/
soap organic/soap; cheese organic/cheese; chocolate organic/; apple translucent/apple; tomato organic/tomato
leaf organic/leaf; grass organic/grass; bone organic/bone; ivory organic/ivory; tooth organic/tooth
egg organic/eggshell; paper paper/; cardboard paper/cardboard; newspaper paper/newsprint; parchment paper/parchment
wet stone/; burnt wood/
spoon finished_metals/; cutlery finished_metals/; armor alloys/; screw alloys/brass; trumpet finished_metals/brass
jar glasses/glass; phone glasses/; boots leather/; wallet leather/; pillow cloth/; socks cloth/; napkin cloth/linen
rope cloth/burlap; cable rubber/; hose rubber/; door wood/; guitar wood/; "wooden floor" wood/; book paper/
"toilet paper" paper/tissue; "ice cube" crystals/ice; keyboard plastics/; lips translucent/skin; leaves organic/leaf
rubies gems/ruby; boxes paper/cardboard; lenses glasses/; vases ceramics/; tyres rubber/; mirrors finished_metals/
"foggy glass" glasses/frosted; "swimming pool" liquids/pool; "white wall" paints/wall_paint
"rose gold" finished_metals/; "leather sofa" leather/; "olive oil" liquids/olive
"rusty metal" time_varying/; "grey plastic" plastics/grey
"""
TABLE = [entry.strip().rsplit(" ", 1) for line in FIRST.split("\n") for entry in line.split(";") if entry.strip()]


@pytest.mark.parametrize(("words", "first"), TABLE, ids=[words for words, _ in TABLE])
def test_an_everyday_word_finds_something_sensible_first(words, first):
    found = presets.search(words.strip('"'))
    assert found, words
    assert found[0].id.startswith(first), [preset.id for preset in found[:5]]


def test_the_table_is_as_long_as_promised():
    assert len(TABLE) >= 120


def test_words_are_whole_words_first():
    """As long as any preset has the word, none is found by a part of another."""
    assert not any("carbide" in preset.id for preset in presets.search("car"))
    assert any("carbide" in preset.id for preset in presets.search("carb"))
    assert not any("marble" in preset.id for preset in presets.search("mar") if "mar" in preset.name.lower().split())


def test_every_word_has_to_be_found():
    both = {preset.id for preset in presets.search("polished copper")}
    assert both == {"finished_metals/copper_polished"}
    assert presets.search("copper zzz") == []
    assert len(presets.search("  ")) == len(presets.all_presets())


def test_where_nothing_has_every_word_the_last_ones_count():
    """In the panel; a script gets what it asked for."""
    everything = presets.all_presets().values()
    words, found = nearest("scratched old oak", everything)
    assert words == "oak"
    assert found == presets.search("oak")
    assert nearest("red oak zzz", everything) == ("zzz", [])
    assert nearest("red car", everything)[0] == "red car"
    assert nearest("  ", everything)[1] == list(everything)


@pytest.mark.parametrize("group", WORDS["same"], ids=lambda group: group[0])
def test_spellings_find_the_same(group):
    found = [[preset.id for preset in presets.search(word)] for word in group]
    assert all(of == found[0] for of in found)


def test_every_meaning_finds_something():
    """Otherwise the table names what is not there."""
    assert [word for word in (*WORDS["means"],) if not presets.search(word)] == []


def test_accents_capitals_and_plurals_do_not_matter():
    for a, b in (("GOLD", "gold"), ("metals", "metal"), ("Papér", "paper"), ("rubies", "ruby"), ("brushes", "brush")):
        assert presets.search(a) == presets.search(b)


def test_a_search_is_quick_enough_for_every_key():
    """A redraw takes 5 ms at most; a search over all presets is to be less than the reading of one file of each."""
    everything = list(presets.all_presets().values())
    search("gold", everything)
    start = time.perf_counter()
    for words in ("gold satin", "carb", "zzz"):
        search(words, everything)
    spent = time.perf_counter() - start
    start = time.perf_counter()
    for preset in everything:
        (presets.FOLDER / f"{preset.id}.toml").read_bytes()
    assert spent < 3.0 * (time.perf_counter() - start)


def test_every_preset_that_ships_has_a_family():
    shipped = presets.shipped().values()
    assert {families.of(preset) for preset in shipped} == set(families.TITLES)
    named = [identity for family in families.TABLE for identity in family.get("presets", ())]
    assert [identity for identity in named if identity not in presets.shipped()] == []
    assert len(shipped) >= 650


def test_a_users_own_folder_is_a_family_of_its_own():
    assert families.title("my_things/one") == "My Things"
