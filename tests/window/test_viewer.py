"""The BRDF Viewer, in a real window."""


def test_the_lobe_is_drawn_over_the_scene(run):
    """Where a surface was clicked; behind things it is hidden, edits change it at once, and it leaves nothing."""
    found = run("steps_viewer", "lobe")
    assert found["ms"]["changed"] < found["ms"]["same"] + 16.0


def test_plots_show_what_is_measured(run):
    """The window goes on meanwhile, Esc stops, and the GPU writes a PNG."""
    run("steps_viewer", "plots")


def test_a_click_shows_the_material_of_the_face(run):
    """With what its texture is there."""
    run("steps_viewer", "click")
