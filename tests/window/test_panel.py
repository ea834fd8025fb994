"""What artists do in the panel, in a real window."""


def test_pick_search_apply_edit_undo_redo(run):
    """By mouse and keys alone."""
    run("steps_panel", "picks_and_applies")
