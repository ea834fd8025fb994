# SPDX-License-Identifier: GPL-3.0-or-later
"""What Automatic, the advice and the material builder need to know of a scene, read in one walk over its objects.

Numbers that Blender answers at once (samples, clamps, caustics, passes) are not copied: read them from ``scene``.
Facts are a snapshot. Panels keep them until the file changes (``ui/watch.py``); everybody else reads them for each call
and hands them on, as ``of`` takes a scene or its facts.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from functools import cached_property
from math import atan2, radians
from typing import TYPE_CHECKING

import bpy
from mathutils import Vector

from ...nodegroups import REVISION_KEY, versions
from ..models import MODELS
from ..models.estimators import NATIVE
from . import lamps, origin, rays, roles
from .choice import bindable
from .reading import bound_slots, is_ours, origin_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from bpy.types import Collection, Material, Node, NodeTree, Object, Scene

    from .material import Origin

SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "POINTCLOUD", "CURVES"}
SMALL_ANGLE = radians(10.0)  # seen from the objects: a narrower light is rarely hit by a random mirror direction
SMALL_SUN = radians(5.0)  # the same for a sun, whose light is all in its disc
TEXTURES = ("ShaderNodeTex", "ShaderNodeNewGeometry", "ShaderNodeVolumeInfo")  # what varies with the direction
BRINGS_INSTANCES = {"VERTS", "FACES"}


@dataclass(frozen=True)
class Light:
    """A light of the render. via: the instance, particles or nodes that bring it; "" for an object of the scene."""

    item: Object
    via: str
    small: bool

    @property
    def name(self) -> str:
        return f'"{self.item.name}"' + (f" (by {self.via})" if self.via else "")

    @property
    def sized(self) -> bool:
        return lamps.size(self.item) > 0.0

    @property
    def sampled(self) -> bool:
        return bool(self.item.data.cycles.use_multiple_importance_sampling)


@dataclass(frozen=True)
class Emitter:
    """An object whose material shines. strength: the largest in its node tree; 1 where something drives it."""

    name: str
    strength: float
    small: bool


@dataclass(frozen=True)
class Sky:
    """The world. kind: "", "even" or "picture"; sun_disc: the Sky Texture that shows one, if any.

    sampled: whether Cycles sends rays to its bright parts; volume: whether it is filled with a medium.
    """

    kind: str = ""
    sun_disc: str = ""
    sampled: bool = True
    volume: bool = False


@dataclass(frozen=True)
class Traits:
    """What a node tree holds that matters to lights."""

    strength: float = 0.0
    transparent: bool = False
    volume: bool = False


@dataclass(frozen=True)
class SceneFacts:
    """See the module. Names are those of objects, or of the world.

    seen_through: objects with a transparent material; unshadowed: those whose Shadow visibility is off; shifted: those
    with a Shading Offset of the shadow terminator; volumes: media; ours: materials that we built, in use; groups: light
    groups that something is in.
    """

    scene: Scene
    lights: tuple[Light, ...]
    emitters: tuple[Emitter, ...]
    sky: Sky
    volumes: tuple[str, ...]
    seen_through: tuple[str, ...]
    unshadowed: tuple[str, ...]
    shifted: tuple[str, ...]
    catchers: tuple[str, ...]
    groups: tuple[str, ...]
    ours: tuple[Material, ...]

    @cached_property
    def refusals(self) -> dict[lamps.Light, str]:
        """The lights at which the formula cannot be evaluated, and why."""
        return {light: why for light in self._bindable if (why := lamps.refusal(light)) is not None}

    @cached_property
    def followable(self) -> list[lamps.Light]:
        """The lights at which the formula can be evaluated, strongest first."""
        return [light for light in self._bindable if light not in self.refusals]

    @cached_property
    def _bindable(self) -> list[lamps.Light]:
        return lamps.all_lights(self.scene)

    @cached_property
    def _in_rig(self) -> list[lamps.Light]:
        return lamps.with_numbers(self.followable)

    def to_bind(self, estimator: str, model: str) -> tuple[lamps.Light, ...]:
        """``lamps_to_bind`` of the scene."""
        if estimator in NATIVE or MODELS[model].transparent:
            return ()
        return bindable(self._in_rig, estimator, model)

    def unbound(self, bound: Iterable[lamps.Light]) -> list[Light]:
        """The lights that are not among ``bound``."""
        own = {light.item for light in bound if not (light.source or light.in_set)}
        brought = {light.item for light in bound if light.source or light.in_set}
        return [one for one in self.lights if one.item not in (brought if one.via else own)]

    def bound_slots(self, made: Material) -> set[str]:
        """The lights that one of our materials reads, as slots of the rig; cached."""
        if made not in self._bound_slots:
            self._bound_slots[made] = bound_slots(made)
        return self._bound_slots[made]

    @cached_property
    def _bound_slots(self) -> dict[Material, set[str]]:
        return {}

    @cached_property
    def different_rays(self) -> float:
        """``rays.different_rays``."""
        return rays.different_rays(self.scene)

    @cached_property
    def origins(self) -> dict[Material, Origin | None]:
        """What our materials were built from; None of one that lost its node group."""
        return {made: _origin(made) for made in self.ours}

    @property
    def is_soft(self) -> bool:
        """Whether there is a broad light, on which Cycles samples random points."""
        return not all([one.small for one in self.lights] + [one.small for one in self.emitters])


def of(scene: Scene | SceneFacts, *, update: bool = True) -> SceneFacts:
    """The facts of a scene; facts are returned unchanged.

    update: let Blender evaluate pending changes, such as a script's. A draw function must not.
    """
    if isinstance(scene, SceneFacts):
        return scene
    if update:
        for layer in scene.view_layers:
            if layer.use:
                layer.update()
    brought = _brought(scene)
    found = dict.fromkeys(item for item, _ in brought)
    of_trees: dict[NodeTree, Traits] = {}
    looks: dict[Material, Traits] = {}
    materials: dict[Object, list[Material]] = {
        item: _materials(item) for item in found if item.type in SURFACES or item.type == "VOLUME"
    }
    for material in {one for used in materials.values() for one in used}:
        tree = versions.used_nodes(material)
        looks[material] = Traits() if tree is None else _traits(tree, of_trees)
        if record := origin.read(material):  # what an artist added to it counts, and a sheet, which shadow rays pass
            transparent = looks[material].transparent or record.preset.is_sheet
            looks[material] = replace(looks[material], transparent=transparent, volume=False)
    shining = {item: max((looks[one].strength for one in used), default=0.0) for item, used in materials.items()}
    middle = _middle([item for item, strength in shining.items() if strength == 0.0])
    sky = _sky(scene.world, of_trees)
    volumes = [item.name for item, used in materials.items()
               if item.type == "VOLUME" or any(looks[one].volume for one in used)]  # fmt: skip
    return SceneFacts(
        scene,
        tuple(
            Light(item, via, _is_small(item, middle))
            for item, via in brought
            if item.type == "LIGHT" and not _is_portal(item)
        ),
        tuple(
            Emitter(item.name, strength, _angle(max(item.dimensions), item, middle) < SMALL_ANGLE)
            for item, strength in shining.items()
            if strength > 0.0
        ),
        sky,
        (*([f'world "{scene.world.name}"'] if sky.volume else []), *sorted(volumes)),
        tuple(sorted(
            item.name for item, used in materials.items()
            if any(looks[one].transparent and one.use_transparent_shadow for one in used)
        )),
        tuple(sorted(item.name for item in materials if not item.visible_shadow)),
        tuple(sorted(item.name for item in materials if item.shadow_terminator_shading_offset > 0.0)),
        tuple(sorted(item.name for item in materials if item.is_shadow_catcher)),
        tuple(sorted({item.lightgroup for item in found if item.lightgroup} & _group_names(scene))),
        tuple(sorted((one for one in looks if is_ours(one)), key=lambda one: one.name)),
    )  # fmt: skip


def _origin(made: Material) -> Origin | None:
    return origin_of(made) if roles.node(made, roles.MODEL) is not None else None


# What is rendered


def _brought(scene: Scene) -> list[tuple[Object, str]]:
    """Each object that is rendered, and what brings it: "" for a plain object of the scene, which instances may repeat.

    Of several instances the first is named.
    """
    plain = [item for item in lamps.rendered(scene) if not item.hide_render]
    waiting = [(item, f'instances of "{item.parent.name}"' if _is_copied(item) else "") for item in plain]
    known, behind = {scene}, scene.background_set
    while behind is not None and behind not in known:
        known.add(behind)
        via = f'the background set "{behind.name}"'
        waiting += [(item, via) for item in lamps.rendered(behind) if not item.hide_render]
        behind = behind.background_set
    done: dict[tuple[Object, bool], str] = {}
    for item, via in waiting:  # which grows meanwhile
        if (item, bool(via)) not in done:
            done[item, bool(via)] = via
            waiting += [(one, via or f'the instance "{item.name}"') for one in _instances(item, scene)]
    return [(item, via) for (item, _), via in done.items()]


def _is_copied(item: Object) -> bool:
    """Whether only copies of it are rendered, on its parent's vertices or faces."""
    return item.parent is not None and item.parent.instance_type in BRINGS_INSTANCES


def _instances(item: Object, scene: Scene) -> Iterator[Object]:
    """What an object brings: collections, particles and what Geometry Nodes instance."""
    if item.instance_type == "COLLECTION" and item.instance_collection is not None:
        yield from _inside(item.instance_collection)
    for system in item.particle_systems:
        how = system.settings
        if how.render_type == "OBJECT" and how.instance_object is not None:
            yield how.instance_object
        elif how.render_type == "COLLECTION" and how.instance_collection is not None:
            yield from _inside(how.instance_collection)
    trees = [one for one in item.modifiers if one.type == "NODES" and one.show_render and one.node_group]
    if trees and all(one.show_viewport for one in trees) and (evaluated := _evaluated(item, scene)) is not None:
        yield from _referred_to(evaluated)
    else:  # Blender evaluates what the viewport shows: of the rest, what the nodes name
        yield from (found for one in trees for found in _named(one.node_group, versions.modifier_inputs(one)))


def _inside(collection: Collection) -> Iterator[Object]:
    if not collection.hide_render:
        yield from (item for item in collection.objects if not item.hide_render)
        for child in collection.children:
            yield from _inside(child)


def _evaluated(item: Object, scene: Scene) -> Object | None:
    layer = next((one for one in scene.view_layers if item.name in one.objects), None)
    found = item.evaluated_get(layer.depsgraph) if layer is not None and layer.depsgraph is not None else item
    return found if found.is_evaluated else None


def _referred_to(evaluated: Object) -> Iterator[Object]:
    """By the instances' references, of which there are few however many instances there are."""
    waiting = [evaluated.evaluated_geometry()]
    while waiting:
        for one in waiting.pop().instance_references():
            if isinstance(one, bpy.types.Object):
                yield one.original
            elif isinstance(one, bpy.types.Collection):
                yield from _inside(one.original)
            elif isinstance(one, bpy.types.GeometrySet):
                waiting.append(one)


def _named(tree: NodeTree, found: list[object]) -> Iterator[Object]:
    """Objects and collections that nodes or their inputs refer to."""
    found += [socket.default_value for node in tree.nodes for socket in node.inputs
              if socket.type in {"OBJECT", "COLLECTION"} and not socket.is_linked]  # fmt: skip
    for one in found:
        if isinstance(one, bpy.types.Object):
            yield one
        elif isinstance(one, bpy.types.Collection):
            yield from _inside(one)


# What it is


def _middle(items: Iterable[Object]) -> Vector:
    places = [item.matrix_world.translation for item in items]
    return sum(places, Vector()) / max(len(places), 1)


def _angle(extent: float, item: Object, middle: Vector) -> float:
    """The angle at which something so broad is seen from the middle of the objects."""
    return 2.0 * atan2(extent / 2.0, (item.matrix_world.translation - middle).length)


def _is_portal(item: Object) -> bool:
    """Whether a light only guides rays to the world."""
    return item.data.type == "AREA" and item.data.cycles.is_portal


def _is_small(item: Object, middle: Vector) -> bool:
    """Whether a random mirror direction rarely hits this light: all points and spots, and lights below the angle."""
    if item.data.type == "SUN":
        return item.data.angle < SMALL_SUN
    return item.data.type != "AREA" or _angle(lamps.size(item), item, middle) < SMALL_ANGLE


def _materials(item: Object) -> list[Material]:
    return [slot.material for slot in item.material_slots if slot.material is not None]


def _traits(tree: NodeTree, known: dict[NodeTree, Traits]) -> Traits:
    found = _of_tree(tree, known)
    ends = [node for node in tree.nodes if _is_output(node)]
    return Traits(found.strength, found.transparent, any(node.inputs["Volume"].is_linked for node in ends))


def _of_tree(tree: NodeTree, known: dict[NodeTree, Traits]) -> Traits:
    """What its surface holds, also within groups; each group is read once, and ours not at all."""
    if tree in known:
        return known[tree]
    known[tree] = Traits()  # of a group within itself
    strength, transparent = 0.0, False
    for node in _used(tree):
        if node.bl_idname == "ShaderNodeGroup":
            if node.node_tree is not None and REVISION_KEY not in node.node_tree:
                inner = _of_tree(node.node_tree, known)
                strength, transparent = max(strength, inner.strength), transparent or inner.transparent
        elif node.bl_idname == "ShaderNodeEmission":
            strength = max(strength, _strength(node, "Strength", "Color"))
        elif node.bl_idname == "ShaderNodeBsdfPrincipled":
            strength = max(strength, _strength(node, "Emission Strength", "Emission Color"))
            alpha = node.inputs["Alpha"]
            transparent |= alpha.is_linked or alpha.default_value < 1.0
        transparent |= node.bl_idname == "ShaderNodeBsdfTransparent"
    known[tree] = Traits(strength, transparent)
    return known[tree]


def _strength(node: Node, strength: str, color: str) -> float:
    level, tint = node.inputs[strength], node.inputs[color]
    if not tint.is_linked and not any(tint.default_value[:3]):
        return 0.0
    return 1.0 if level.is_linked else max(level.default_value, 0.0)


def _is_output(node: Node) -> bool:
    outputs = {"NodeGroupOutput", "ShaderNodeOutputMaterial", "ShaderNodeOutputWorld"}
    return node.bl_idname in outputs and getattr(node, "target", "ALL") != "EEVEE"


def _used(tree: NodeTree) -> Iterator[Node]:
    """The nodes that feed its output, but not by way of the input Volume."""
    sources: dict[str, list[Node]] = defaultdict(list)
    for link in tree.links:
        if not (link.is_muted or (_is_output(link.to_node) and link.to_socket.name == "Volume")):
            sources[link.to_node.name].append(link.from_node)
    waiting = [node for node in tree.nodes if _is_output(node)]
    seen = {node.name for node in waiting}
    while waiting:
        for node in sources[waiting.pop().name]:
            if node.name not in seen:
                seen.add(node.name)
                waiting.append(node)
                if not node.mute:
                    yield node


def _sky(world: bpy.types.World | None, known: dict[NodeTree, Traits]) -> Sky:
    if world is None:
        return Sky()
    sampled = world.cycles.sampling_method != "NONE"
    tree = versions.used_nodes(world)
    if tree is None:
        return Sky("even" if any(world.color) else "", sampled=sampled)
    nodes = list(_deeply(tree, set()))
    shines = any(
        _strength(node, "Strength", "Color") > 0.0 for node in nodes if node.bl_idname == "ShaderNodeBackground"
    )
    shines |= _of_tree(tree, known).strength > 0.0
    picture = shines and any(node.bl_idname.startswith(TEXTURES) for node in nodes)
    discs = [node.name for node in nodes if node.bl_idname == "ShaderNodeTexSky" and _shows_disc(node)]
    volume = any(node.inputs["Volume"].is_linked for node in tree.nodes if _is_output(node))
    kind = "picture" if picture else "even" if shines else ""
    return Sky(kind, discs[0] if shines and discs else "", sampled, volume)


def _deeply(tree: NodeTree, seen: set[NodeTree]) -> Iterator[Node]:
    seen.add(tree)
    for node in _used(tree):
        yield node
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None and node.node_tree not in seen:
            yield from _deeply(node.node_tree, seen)


def _shows_disc(sky: Node) -> bool:
    return sky.sun_disc and sky.sun_intensity > 0.0 and sky.sky_type not in {"PREETHAM", "HOSEK_WILKIE"}


def _group_names(scene: Scene) -> set[str]:
    return {one.name for layer in scene.view_layers if layer.use for one in layer.lightgroups}
