"""What artists do in the Shader Editor, in a real window."""


def test_a_node_is_found_by_typing_and_mixed(run):
    """Into the Add menu; it follows the mouse, and its links are dragged. One Ctrl-Z takes one link back."""
    run("steps_nodes", "adds_and_mixes")


def test_the_add_menu_lists_the_models(run):
    """Add > Shader > V-Groove; the first is a metal."""
    assert run("steps_nodes", "menu")["label"] == "Metal"


def test_the_sidebar_of_the_shader_editor_applies_and_edits(run):
    """The nodes shown are the new material's."""
    run("steps_nodes", "sidebar")
