"""From formulas to text: kernels, the table of a scene's kinds, and the manifest. No file is touched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from modelgen.assembly import require
from modelgen.codegen.amalgamation import HEADER, abi, header_text
from modelgen.codegen.casadi_external_entries import entries_text, internal_functions
from modelgen.codegen.derivative_kernels import NO_DERIVATIVES, derivatives_text
from modelgen.codegen.kernel_table import table_text
from modelgen.codegen.load_branches import with_branches
from modelgen.codegen.manifest import Json, Manifest
from modelgen.codegen.manifest_model import instance_of, kinds_of, parameters_of
from modelgen.codegen.scene_step import MOST_INLINED, inlined
from modelgen.codegen.shared_jets import shared_kernels, with_calls
from modelgen.codegen.unused_pose_inputs import unused_pose_inputs
from modelgen.derivation import Derivation, Formula, derive
from modelgen.differentiation import packed_formulas
from modelgen.errors import expect
from modelgen.interruption import nothing_swallowed
from modelgen.model import Model
from modelgen.notation import unit_of
from modelgen.scene.contact_groups import listed

PREFIX = "mg_kernels"
DERIVATIVES = "derivatives.c"
MOST_COMPOSED = 700  # instructions of a composed right-hand side that is compiled
ELEMENTARY = (  # functions of math.h that the core has its own of, equal to the last bit on every machine
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "pow"),
    *("asinh", "hypot", "fmin", "fmax"),
)
MODEL_HEAD = """/* The kernels of one scene's kinds, and the table through which the core calls them. */
#include "modelgen.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif

#if defined(__GNUC__)
#define MG_INLINE static inline __attribute__((always_inline))
#else
#define MG_INLINE static inline
#endif
#if defined(__GNUC__) && !defined(__clang__) /* GCC does not schedule before registers unless told to */
#define MG_SCHEDULED __attribute__((optimize("schedule-insns")))
#else
#define MG_SCHEDULED
#endif
#define casadi_int long long
#define casadi_real mg_real
#define CASADI_SYMBOL_EXPORT MG_API

#if !defined(MG_REAL_FLOAT) && !defined(MG_REAL_LONG)
{elementary}
#endif
#include "kernels.c"
{derivatives}

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

    @property
    def derivatives(self) -> bool:
        """Whether runs can be differentiated."""
        return DERIVATIVES in self.files


@nothing_swallowed()
def emit(derivation: Derivation, derivatives: bool = False) -> Package:
    """The C text and the manifest of a derivation; equal derivations give equal text.

    Args:
        derivation: what `derive` returned.
        derivatives: whether derivatives of runs can be asked for (`sensitivity`); they take C text,
            compile time and nothing else.

    Raises ModelgenError if it is given something else.
    """
    expect("emit", derivation, Derivation)
    if derivatives and derivation.model.scene.pools:  # whose slots a change of one body would change alike
        derivation = derive(require(listed(derivation.model.whole)))
    derivation = with_branches(derivation)
    compiled = [
        each for each in derivation.formulas if each.role != "rhs" or runs_in_steps(derivation.model, each)
    ]
    internal = {formula.name: f"{PREFIX}_f{index}" for index, formula in enumerate(compiled)}
    packed = packed_formulas(derivation, compiled) if derivatives else ()
    files = {
        "kernels.c": _kernels(derivation.model, compiled),
        "model.c": _head(bool(packed)) + table_text(derivation, internal),
        HEADER: header_text(),
    }
    if derivatives:
        files[DERIVATIVES] = derivatives_text(packed)
    manifest = Manifest(
        abi=abi(),
        functions={formula.name: _entry(formula) for formula in compiled},
        composed={each.name: _entry(each) for each in derivation.formulas if each not in compiled},
        kinds=kinds_of(derivation.model),
        instance=instance_of(derivation.model) | parameters_of(derivation.model.whole),
    )
    return Package(derivation.model.scene.name, files, manifest)


def runs_in_steps(model: Model, composed: Formula) -> bool:
    """Whether the stages of steps use the composed right-hand side: it has no inputs, no loads and no
    driven bodies, whose work is asked for too, no faces that may rest, and is small, so that it costs little
    to compile."""
    moves = {model.body_kinds[body.kind].motion for body in model.bodies}
    plain = not (model.scene.inputs or model.loads or model.patches or model.limits or "driven" in moves)
    return plain and composed.instructions <= MOST_COMPOSED


def _head(has_derivatives: bool) -> str:
    return MODEL_HEAD.format(
        elementary="\n".join(f"#define {name} mg_{name.removeprefix('f')}" for name in ELEMENTARY),
        derivatives=f'#include "{DERIVATIVES}"' if has_derivatives else NO_DERIVATIVES,
    )


def _kernels(model: Model, formulas: list[Formula]) -> str:
    options: dict[str, Any] = {"static_aux": True, "verbose": False, "with_header": False, "prefix": PREFIX}
    generator = ca.CodeGenerator("kernels.c", options)
    functions = [formula.function for formula in formulas]
    shared = shared_kernels(model, formulas)
    jets = list({call.jet.name(): call.jet for each in shared.values() for call in each.calls}.values())
    written = [shared[each.name()].rest if each.name() in shared else each for each in functions] + jets
    for function in written:
        generator.add(function)
    text = with_calls(
        internal_functions(str(generator.dump()), written),
        {k: shared[each.name()] for k, each in enumerate(functions) if each.name() in shared},
        {jet.name(): k for k, jet in enumerate(jets, start=len(functions))},
    ) + entries_text(functions, "casadi")
    most = MOST_COMPOSED if model.scene.fold else MOST_INLINED
    small = [k for k, each in enumerate(formulas) if each.role == "rhs" and each.instructions <= most]
    return inlined(text, [f"casadi_f{k}" for k in small])  # which stands for PREFIX_f{k}


def _entry(formula: Formula) -> Json:
    function = formula.function
    unused = unused_pose_inputs(function)
    return {
        "inputs": [_argument(name, function.numel_in(name)) for name in function.name_in()],
        "outputs": [_argument(name, function.numel_out(name)) for name in function.name_out()],
        "instructions": formula.instructions,
        "citation": formula.citation,
        **({"unused": unused} if unused else {}),
    }


def _argument(name: str, size: int) -> Json:
    return {"name": name, "shape": [int(size)], "unit": unit_of(name, int(size))}
