"""From formulas to text: kernels, the table of a scene's kinds, and the manifest. No file is touched."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from modelgen.codegen.amalgamation import HEADER, SOURCE, abi, header_text
from modelgen.codegen.kernel_table import table_text
from modelgen.codegen.manifest import Json, Manifest
from modelgen.codegen.manifest_instance import instance_of, kinds_of, parameters_of
from modelgen.codegen.unused_inputs import unused_inputs
from modelgen.derivation import Derivation, Formula
from modelgen.errors import expect
from modelgen.notation import unit_of

PREFIX = "mg_kernels"
ENTRY = re.compile(  # the exported function of a kernel: head, name, internal function
    r"(^CASADI_SYMBOL_EXPORT int (mg_\w+)\([^\n]*\)\{)\n"
    r"  return (\w+)\(arg, res, iw, w, mem\);\n",
    re.MULTILINE,
)

MODEL_HEAD = """/* The kernels of one scene's kinds, and the table through which the core calls them. */
#include "modelgen.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif

#define casadi_int long long
#define casadi_real mg_real
#define CASADI_SYMBOL_EXPORT MG_API

/* Calls a kernel for a caller that may pass null pointers: such inputs are zero, such outputs are dropped. */
static int mg_call(int (*kernel)(const mg_real **, mg_real **, casadi_int *, mg_real *, int), int n_in,
                   int n_out, const mg_real **arg, mg_real **res) {{
  static const mg_real zeros[{longest_in}] = {{0}};
  mg_real dropped[{longest_out}];
  const mg_real *given[{most_in}];
  mg_real *wanted[{most_out}];
  for (int i = 0; i < n_in; i++) given[i] = arg[i] ? arg[i] : zeros;
  for (int i = 0; i < n_out; i++) wanted[i] = res[i] ? res[i] : dropped;
  return kernel(given, wanted, 0, 0, 0);
}}

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
        "model.c": _head(compiled) + table_text(derivation, internal),
        HEADER: header_text(),
    }
    manifest = Manifest(
        abi=abi(),
        functions={formula.name: _entry(formula) for formula in compiled},
        composed={formula.name: _entry(formula) for formula in derivation.formulas if formula.role == "rhs"},
        kinds=kinds_of(derivation.model),
        instance=instance_of(derivation.model) | parameters_of(derivation.model.whole),
    )
    return Package(derivation.model.scene.name, files, manifest)


def file_names() -> set[str]:
    """Names of all C files of a package, with those of the core that a standalone program is compiled
    with."""
    return {"kernels.c", "model.c", HEADER, SOURCE}


def _head(formulas: list[Formula]) -> str:
    functions = [formula.function for formula in formulas]
    return MODEL_HEAD.format(
        longest_in=max((f.numel_in(i) for f in functions for i in range(f.n_in())), default=1),
        longest_out=max((f.numel_out(i) for f in functions for i in range(f.n_out())), default=1),
        most_in=max((f.n_in() for f in functions), default=1),
        most_out=max((f.n_out() for f in functions), default=1),
    )


def _kernels(formulas: list[Formula]) -> str:
    options: dict[str, Any] = {"static_aux": True, "verbose": False, "with_header": False, "prefix": PREFIX}
    generator = ca.CodeGenerator("kernels.c", options)
    for formula in formulas:
        generator.add(formula.function)
    counts = {f.name: (f.function.n_in(), f.function.n_out()) for f in formulas}
    return without_null_tests(str(generator.dump()), counts)


def without_null_tests(text: str, counts: Mapping[str, tuple[int, int]]) -> str:
    """CasADi's C text with one test for null pointers at each exported entry in place of one an element.

    The core passes no null pointers; callers from outside may, by CasADi's interface, for inputs that are
    zero and outputs that they do not want. `counts`: inputs and outputs by the kernel's name.
    """
    text = re.sub(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0", r"arg[\1][\2]", text)
    text = re.sub(r"if \(res\[(\d+)\]!=0\) res\[\1\]", r"res[\1]", text)
    assert "]? arg[" not in text
    assert "]!=0)" not in text

    def entry(match: re.Match[str]) -> str:
        head, name, internal = match.groups()
        n_in, n_out = counts[name]
        call = f"mg_call({internal}, {n_in}, {n_out}, arg, res)"
        return f"{head}\n  (void)iw, (void)w, (void)mem;\n  return {call};\n"

    return ENTRY.sub(entry, text)


def _entry(formula: Formula) -> Json:
    function = formula.function
    unused = unused_inputs(function)
    return {
        "inputs": [_argument(name, function.numel_in(name)) for name in function.name_in()],
        "outputs": [_argument(name, function.numel_out(name)) for name in function.name_out()],
        "instructions": formula.instructions,
        "citation": formula.citation,
        **({"unused": unused} if unused else {}),
    }


def _argument(name: str, size: int) -> Json:
    return {"name": name, "shape": [int(size)], "unit": unit_of(name, int(size))}
