# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials into the slots of objects: whole objects, one slot, or in Edit Mode the selected faces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bmesh
import bpy

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bpy.types import Context, Material, Object

TYPES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "POINTCLOUD", "CURVES", "VOLUME"}
IN_PARTS = {"EDIT_MESH", "EDIT_CURVE", "EDIT_SURFACE", "EDIT_TEXT"}  # modes in which a part can have its own material


def refusal(item: Object) -> str:
    """Why an object cannot be given a material here, and what to do; empty if it can. Nothing is changed."""
    if item.type not in TYPES:
        return f"{item.name} ({item.type.lower()}) cannot have a material; select a mesh, curve or text"
    if item.library is not None:
        return f"{item.name} is linked from {item.library.name}; choose Object > Library Override > Make first"
    if _is_locked(item) and not item.material_slots:
        source = item.data.library.name if item.data.library else "another file"
        what = f"{item.name} has no material slot, and its {item.type.lower()} data is linked from {source}"
        return f"{what}; add a slot in that file, or choose Object > Relations > Make Local > Selected Objects and Data"
    return ""


def _is_locked(item: Object) -> bool:
    return item.data.library is not None or item.data.override_library is not None


def apply(material: Material, objects: Iterable[Object]) -> int:
    """Give ``material`` to the active slot of each object that can have one; returns how many took it."""
    able = [item for item in objects if not refusal(item)]
    for item in able:
        give(material, item, item.active_material_index)
    return len(able)


def give(material: Material, item: Object, index: int = 0, *, alone: bool = False) -> None:
    """Give ``material`` to a slot of an object, which gets one if it has none.

    The slot belongs to the mesh, and so to every object that shares it; ``alone``: to this object, if it shares its
    mesh. So it does where the mesh is linked from another file.
    """
    if not item.material_slots:
        item.data.materials.append(None)
    slot = item.material_slots[min(index, len(item.material_slots) - 1)]
    if _is_locked(item) or (alone and is_shared(item)):
        slot.link = "OBJECT"
    slot.material = material


def is_shared(item: Object) -> bool:
    """Whether another object has the same mesh, curve or text."""
    return bool(item.data.users - item.data.use_fake_user > 1)


def sharing(objects: Iterable[Object]) -> list[Object]:
    """Other objects that show what the slots of ``objects`` show, as they share their meshes."""
    given = {item for item in objects if any(slot.link == "DATA" for slot in item.material_slots)}
    data = {item.data for item in given}
    return [item for item in bpy.data.objects if item.data in data and item not in given]


def in_parts(context: Context) -> bool:
    """Whether the mode is one in which the selected faces, splines or letters get the material."""
    return context.mode in IN_PARTS


def parts_selected(context: Context) -> bool:
    """Whether something is selected there; of curves and texts Blender does not tell."""
    return any(item.type != "MESH" or _faces(item)[0] for item in context.objects_in_mode_unique_data)


def give_to_parts(material: Material, context: Context) -> None:
    """What is selected in Edit Mode gets the material, as by Blender's own Assign."""
    for item in context.objects_in_mode_unique_data:
        found = next((k for k, slot in enumerate(item.material_slots) if slot.material == material), None)
        if found is None:
            if item.type == "MESH" and not item.material_slots and _faces(item)[0] < _faces(item)[1]:
                item.data.materials.append(None)  # the slot of the other faces
            item.data.materials.append(material)
            found = len(item.material_slots) - 1
        item.active_material_index = found
    bpy.ops.object.material_slot_assign()


def _faces(item: Object) -> tuple[int, int]:
    """How many faces of a mesh in Edit Mode are selected, and how many there are."""
    faces = bmesh.from_edit_mesh(item.data).faces
    return sum(face.select for face in faces), len(faces)
