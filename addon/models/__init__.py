# SPDX-License-Identifier: GPL-3.0-or-later
"""What each model is, as data: one file a model, and this registry, which finds them. Imports no bpy.

A file of this folder that holds a ``MODEL`` is a model; its name is the file's. Every layer reads it from here.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from . import estimators, fresnel
from .spec import PLAIN, Form, MeasuredTable, Model, Number, Parameter, Scale

__all__ = [
    "DEFAULT", "MODELS", "PARAMETERS", "PLAIN", "Form", "MeasuredTable", "Model", "Number", "Parameter", "Scale",
    "base_name", "estimators", "fresnel", "label", "lobe_of", "parameter", "symbol",
]  # fmt: skip

DEFAULT = "cook_torrance"  # of a file that names no model
_files = sorted(
    (path.stem for path in Path(__file__).parent.glob("[!_]*.py")), key=lambda name: (name != DEFAULT, name)
)
_found = [import_module(f".{name}", __name__) for name in sorted(_files, key=lambda name: (name != DEFAULT, name))]
MODELS: dict[str, Model] = {of.MODEL.name: of.MODEL for of in _found if hasattr(of, "MODEL")}
# By reference name: a number means the same in every model, but for its default and its tip.
PARAMETERS: dict[str, Parameter] = {
    one.name: one
    for parameters in (
        *(model.parameters + model.lobes for model in MODELS.values()),
        *(kind.parameters for kind in fresnel.KINDS.values()),
    )
    for one in parameters
}


def label(model: str, key: str) -> str:
    """The input of a parameter in groups of a model: "Roughness" of m, "Lobe 2 Roughness" of m_2."""
    base = base_name(key)
    return lobe_of(key) + MODELS[model].labels.get(base, PARAMETERS[base].label)


def symbol(key: str) -> str:
    """What papers call a parameter, and older files its input: "Slope m" of m, "Lobe 2 Slope m" of m_2."""
    of = parameter(key)
    return lobe_of(key) + (of.symbol or of.label)


def lobe_of(key: str) -> str:
    """How the names of a lobe's inputs begin; "" of a model's own."""
    base = base_name(key)
    return "" if base == key else f"Lobe {key[len(base) + 1 :]} "


def base_name(key: str) -> str:
    """The name of a number without that of its lobe: m of m_2."""
    name, _, lobe = key.rpartition("_")
    return name if lobe.isdigit() else key


def parameter(key: str) -> Parameter:
    """The parameter that ``key`` names, of a lobe too; KeyError if there is none."""
    return PARAMETERS[base_name(key)]
