"""From formulas to text: kernels, the table of a scene's kinds, and the manifest. Nothing touches the disk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from modelgen.codegen.amalgamation import HEADER, SOURCE, abi, header_text
from modelgen.codegen.kinds_c import table_text
from modelgen.codegen.manifest import Json, Manifest
from modelgen.codegen.sentence import kinds_of, sentence_of
from modelgen.derive import Derivation, Formula
from modelgen.errors import expect
from modelgen.notation import unit_of

PREFIX = "mg_kernels"

MODEL_HEAD = """/* The kernels of one scene's vocabulary, and the table through which the core calls them. */
#include "modelgen.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif

#define casadi_real mg_real
#define CASADI_SYMBOL_EXPORT MG_API
#include "kernels.c"

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

"""


@dataclass(frozen=True)
class Package:
    """File names with their texts, and the manifest; `files` is what is compiled for the scene alone."""

    name: str
    files: Mapping[str, str]
    manifest: Manifest


def emit(derivation: Derivation) -> Package:
    """The C text and the manifest of a derivation; equal derivations give equal text.

    Raises ModelgenError if it is given something else.
    """
    expect("emit", derivation, Derivation)
    compiled = [formula for formula in derivation.formulas if formula.role != "rhs"]
    internal = {formula.name: f"{PREFIX}_f{index}" for index, formula in enumerate(compiled)}
    files = {
        "kernels.c": _kernels(compiled),
        "model.c": MODEL_HEAD + table_text(derivation, internal),
        HEADER: header_text(),
    }
    manifest = Manifest(
        abi=abi(),
        functions={formula.name: _entry(formula) for formula in compiled},
        composed={formula.name: _entry(formula) for formula in derivation.formulas if formula.role == "rhs"},
        kinds=kinds_of(derivation.model),
        sentence=sentence_of(derivation.model),
    )
    return Package(derivation.model.scene.name, files, manifest)


def file_names() -> set[str]:
    """Of the C text of any package, and of the core that a program of its own needs beside it."""
    return {"kernels.c", "model.c", HEADER, SOURCE}


def _kernels(formulas: list[Formula]) -> str:
    options: dict[str, Any] = {"static_aux": True, "verbose": False, "with_header": False, "prefix": PREFIX}
    generator = ca.CodeGenerator("kernels.c", options)
    for formula in formulas:
        generator.add(formula.function)
    return str(generator.dump())


def _entry(formula: Formula) -> Json:
    function = formula.function
    return {
        "inputs": [_argument(name, function.numel_in(name)) for name in function.name_in()],
        "outputs": [_argument(name, function.numel_out(name)) for name in function.name_out()],
        "instructions": formula.instructions,
        "citation": formula.citation,
    }


def _argument(name: str, size: int) -> Json:
    return {"name": name, "shape": [int(size)], "unit": unit_of(name, int(size))}
