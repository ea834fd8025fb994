# SPDX-License-Identifier: GPL-3.0-or-later
"""What a panel shows, drawn without a window."""

from types import SimpleNamespace


class Recorder:
    """Stands in for a layout: takes every call, remembers texts and operators, refuses unknown properties."""

    def __init__(self):
        self.texts, self.buttons, self.props = [], [], []

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties
        self.props.append(name)

    def label(self, *, text="", icon="NONE"):
        self.texts.append(text)

    def operator(self, name, *, text="", icon="NONE"):
        self.buttons.append((name, text))
        return type("Properties", (), {})()

    def progress(self, *, factor=0.0, text=""):
        assert 0.0 <= factor <= 1.0
        self.texts.append(text)

    def template_icon(self, *, icon_value=0, scale=1.0):
        assert icon_value >= 0  # none without a window

    def template_icon_view(self, owner, name, **_):
        assert name in owner.bl_rna.properties

    def column(self, **_):
        return self

    row = box = split = column


def drawn(extension, kind):
    """What a panel shows; nothing where it is not shown itself. Of other editors without their spaces."""
    context = SimpleNamespace(
        scene=extension.context.scene,
        region=SimpleNamespace(width=280),
        preferences=extension.context.preferences,
        object=extension.context.object,
        selected_objects=extension.context.selected_objects,
        mode=extension.context.mode,
    )
    layout = Recorder()
    if kind.bl_space_type == "VIEW_3D" and hasattr(kind, "poll") and not kind.poll(context):
        return layout
    kind.draw(SimpleNamespace(layout=layout), context)
    return layout
