"""Files, the Asset Browser and Material Preview, in a real window."""

QUICK = 0.2  # seconds of the processor in which Apply feels immediate
SMALL = 3e6  # bytes of a file with twenty presets
DARKEST = 8 / 255  # as displayed; black is 0


def test_blender_starts_with_the_extension_and_warns_of_nothing(run):
    """In the scene that Blender opens."""
    assert run("steps_scene", "starts")["warnings"] == []


def test_twenty_presets_are_quick_and_small_and_render_the_same_without_the_extension(run):
    """Each Apply but the first of all, which reads what Blender's start does not wait for."""
    saved = run("steps_scene", "saves")
    assert {name: seconds for name, seconds in saved["seconds"].items() if seconds > QUICK} == {}
    assert saved["bytes"] < SMALL
    found = run("steps_scene", "reopens", "without")
    assert found["missing"] == []
    assert found["brightest"] > 0.1
    # The same file, Blender, seed and samples on the same machine: the same instructions on the same numbers.
    assert found["difference"] == 0.0


def test_an_asset_is_dragged_onto_an_object_and_can_be_edited(run):
    """From the Asset Browser; one Ctrl-Z takes it back."""
    run("steps_scene", "drags")


def test_material_preview_shows_each_model(run):
    """Neither black nor the magenta of a shader that did not compile; copper is red, the car paint blue."""
    colors = run("steps_scene", "previews")["colors"]
    for name, (r, g, b) in colors.items():
        assert max(r, g, b) > DARKEST, name
        assert not (min(r, b) > 0.5 and g < 0.5 * min(r, b)), name
    red, blue = colors["metal"], colors["car_paint"]
    assert red[0] > red[2]
    assert blue[2] > 2 * blue[0]


def test_the_viewport_is_switched_while_a_value_is_edited(run):
    """Material Preview, Rendered and Solid each show gold; undo and redo work in each."""
    run("steps_scene", "switches")
