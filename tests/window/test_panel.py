"""What artists do in the panel, in a real window."""


def test_pick_search_apply_edit_undo_redo(run):
    """By mouse and keys alone."""
    run("steps_panel", "picks_and_applies")


def test_textures_stay_if_the_box_is_ticked(run):
    """The image of the Principled that is replaced; undone by one Ctrl-Z."""
    run("steps_panel", "keeps_textures")


def test_in_edit_mode_the_selected_face_gets_the_material(run):
    """A face chosen by a click; the others keep theirs."""
    run("steps_panel", "faces")


def test_the_material_tab_has_the_picker(run):
    """Opened by its title, as it is closed at first."""
    run("steps_panel", "material_tab")
