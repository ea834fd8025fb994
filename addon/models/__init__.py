# SPDX-License-Identifier: GPL-3.0-or-later
"""What each model is, as data: one file a model, and this registry, which finds them. Imports no bpy.

A file of this folder that holds a ``MODEL`` is a model; its name is the file's. Every layer reads it from here.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from . import estimators, fresnel
from .spec import Form, Model, Number, Parameter

__all__ = [
    "DEFAULT", "MODELS", "PARAMETERS", "Form", "Model", "Number", "Parameter", "base_name", "estimators", "fresnel",
    "parameter",
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


def base_name(key: str) -> str:
    """The name of a number without that of its lobe: m of m_2."""
    name, _, lobe = key.rpartition("_")
    return name if lobe.isdigit() else key


def parameter(key: str) -> Parameter:
    """The parameter that ``key`` names, of a lobe too; KeyError if there is none."""
    return PARAMETERS[base_name(key)]
