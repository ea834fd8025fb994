# SPDX-License-Identifier: GPL-3.0-or-later
"""vgroove: physically based lighting models for Blender Cycles, rendered as their papers define them.

This file is the Blender extension's entry. It imports nothing at the top, so that the models can be used, and the
tests collected, where there is no Blender.
"""


def register() -> None:
    """Called by Blender when the extension is switched on."""
    from .addon.ui import register

    register()


def unregister() -> None:
    """Called by Blender when the extension is switched off; undoes ``register``."""
    from .addon.ui import unregister

    unregister()


def glTF2ExportUserExtension() -> object:
    """Called by Blender's glTF exporter, which looks for this name in each extension that is switched on."""
    from .addon.blender.gltf import Hooks

    return Hooks()
