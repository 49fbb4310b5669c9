"""From formulas to text: kernels, dispatchers, core and manifest. Nothing touches the disk."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

import casadi as ca

from modelgen.codegen.kinds_c import kinds_text, prototypes
from modelgen.codegen.manifest import Json, Manifest
from modelgen.codegen.sentence import kinds_of, sentence_of
from modelgen.derive import Derivation, Formula
from modelgen.errors import expect
from modelgen.notation import unit_of

PREFIX = "mg_kernels"

MODEL_HEAD = """/* One translation unit: the kernels of the vocabulary, and the core that runs them. */
#include "kinds.h"
#include "modelgen.h"

#if defined(__GNUC__)
#define MG_INLINE __attribute__((always_inline))
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#else
#define MG_INLINE
#endif

#define casadi_real mg_real
#define CASADI_SYMBOL_EXPORT MG_API
"""

MODEL_MIDDLE = """#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "kinds.c"

"""

INNER_LOOP = (
    *("active_solve.c", "bodies.c", "contacts.c", "dop853.c", "islands.c"),
    *("lone.c", "rhs.c", "rk4.c", "step.c", "strain.c"),
)

SEEKING = ("closest.c", "safeguard.c", "seek.c")  # inner loops where a separation function is sought

JOINING = ("joints.c", "lcp_cholesky.c", "lcp_minimum_norm.c")  # and where there are joints

GRIPPING = ("grips.c", "oblique.c", "slip.c", "lcp_cholesky.c", "lcp_minimum_norm.c")  # and with friction

STANDING = (
    *("collocate.c", "lean.c", "margin.c"),
    *("pressure.c", "start_rolling.c", "tracks.c"),
)  # and where faces stand, and roll off over their rims

RUBBING = ("limit_surface.c", "pressing.c", "rubbing.c", "rubs.c")  # and where these have friction

PER_STEP = (
    *("conditions.c", "events.c", "links.c", "project.c", "sample.c", "starts.c", "walk.c"),
    *("lcp_cholesky.c", "lcp_minimum_norm.c", "lcp_residual.c", "place.c"),
    *("qp.c", "qp_pivot.c", "qp_refine.c", "qp_small.c"),
)

HASTE = """
#if defined(__GNUC__) && !defined(__clang__) /* {reason} */
#pragma GCC push_options
#pragma GCC optimize("{level}")
#endif

{includes}
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
"""


@dataclass(frozen=True)
class Package:
    """File names with their texts, and the manifest; `files` is what is compiled and nothing else."""

    name: str
    files: Mapping[str, str]
    manifest: Manifest


def emit(derivation: Derivation) -> Package:
    """The C text and the manifest of a derivation; equal derivations give equal text.

    Raises ModelgenError if it is given something else.
    """
    expect("emit", derivation, Derivation)
    compiled = [formula for formula in derivation.formulas if formula.role != "rhs"]
    core = core_files()
    internal = {formula.name: f"{PREFIX}_f{index}" for index, formula in enumerate(compiled)}
    kernels = _kernels(compiled)
    roles = {formula.role for formula in compiled}
    grips = any(kind.rows > 1 for kind in derivation.model.contact_kinds)
    quick = (*INNER_LOOP, *(SEEKING if "seek" in roles else ()), *(JOINING if "rows" in roles else ()))
    quick += GRIPPING if grips else ()
    quick += STANDING if derivation.model.patches else ()
    quick += RUBBING if any(patch.rubbing >= 0 for patch in derivation.model.patches) else ()
    files = {
        **core,
        "kernels.c": kernels,
        "kinds.c": kinds_text(derivation, internal),
        "model.c": _model(core, prototypes(internal.values(), PREFIX, kernels), quick),
    }
    manifest = Manifest(
        abi=abi_of(core["modelgen.h"]),
        functions={formula.name: _entry(formula) for formula in compiled},
        composed={formula.name: _entry(formula) for formula in derivation.formulas if formula.role == "rhs"},
        kinds=kinds_of(derivation.model),
        sentence=sentence_of(derivation.model),
    )
    return Package(derivation.model.scene.name, files, manifest)


def file_names() -> set[str]:
    """Of the C text of any package."""
    return {*core_files(), "kernels.c", "kinds.c", "model.c"}


def core_files() -> dict[str, str]:
    """The hand-written C files, by name in alphabetical order."""
    folder = resources.files("modelgen.core")
    found = {item.name: item for item in folder.iterdir() if item.name.endswith((".c", ".h"))}
    return {name: found[name].read_text(encoding="utf-8") for name in sorted(found)}


def abi_of(header: str) -> int:
    """The ABI number that the public header defines."""
    match = re.search(r"#define MG_ABI (\d+)", header)
    assert match is not None
    return int(match.group(1))


def _kernels(formulas: list[Formula]) -> str:
    options: dict[str, Any] = {"static_aux": True, "verbose": False, "with_header": False, "prefix": PREFIX}
    generator = ca.CodeGenerator("kernels.c", options)
    for formula in formulas:
        generator.add(formula.function)
    return str(generator.dump())


def _model(core: Mapping[str, str], declared: str, quick: tuple[str, ...]) -> str:
    sources = [name for name in core if name.endswith(".c")]
    groups = {
        "inner": [name for name in sources if name in quick],
        "step": [name for name in sources if name in PER_STEP and name not in quick],
        "rest": [name for name in sources if name not in quick + PER_STEP],
    }
    texts = {group: "".join(f'#include "{name}"\n' for name in names) for group, names in groups.items()}
    wrappers = HASTE.format(
        reason="what the core uses is inlined: these copies are for callers from outside",
        level="O0",
        includes='#include "kernels.c"\n',
    )
    per_step = HASTE.format(reason="once a step: compiled faster", level="Og", includes=texts["step"])
    rest = HASTE.format(
        reason="little work a step, or once a run: compiled fastest", level="O0", includes=texts["rest"]
    )
    return MODEL_HEAD + declared + wrappers + MODEL_MIDDLE + texts["inner"] + per_step + rest


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
