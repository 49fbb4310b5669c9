"""CasADi's C text with entries of our own, the functions that `casadi.external` asks for.

A compiler spends more time on the functions that CasADi writes around a kernel than on most kernels, and on a
test for null pointers at each element. Here the tables are data, functions that CasADi can do without are
left out, and null pointers are tested once, at the entry.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import casadi as ca

EXPORTED = re.compile(
    r"^CASADI_SYMBOL_EXPORT [^\n]*?\b(\w+)\([^\n]*\{(?:[^\n]*\}\n+|\n.*?^\}\n+)", re.M | re.S
)
HEAD = """/* Calls a kernel for a caller that passes null pointers for zeros and for outputs that it drops. */
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

/* What casadi.external asks of a function: itself, then numbers, names and sparsities of its arguments. */
#define MG_ENTRY(name, kernel, inputs, outputs) \\
  MG_API int name(const mg_real **arg, mg_real **res, casadi_int *iw, mg_real *w, int mem) {{ \\
    return (void)iw, (void)w, (void)mem, mg_call(kernel, inputs, outputs, arg, res); \\
  }} \\
  MG_API casadi_int name##_n_in(void) {{ return inputs; }} \\
  MG_API casadi_int name##_n_out(void) {{ return outputs; }} \\
  MG_API const char *name##_name_in(casadi_int i) {{ return mg_names_in_##kernel[i]; }} \\
  MG_API const char *name##_name_out(casadi_int i) {{ return mg_names_out_##kernel[i]; }} \\
  MG_API const casadi_int *name##_sparsity_in(casadi_int i) {{ return mg_sparsity_in_##kernel[i]; }} \\
  MG_API const casadi_int *name##_sparsity_out(casadi_int i) {{ return mg_sparsity_out_##kernel[i]; }}
"""


def internal_functions(text: str, functions: Iterable[ca.Function]) -> str:
    """CasADi's C text of functions without their exported entries and without tests for null pointers.

    Args:
        text: what a `casadi.CodeGenerator` dumps.
        functions: those that were added to it.
    """
    names = "|".join(function.name() for function in functions)
    entries = re.compile(rf"(?:{names})(?:_\w+)?")
    text = EXPORTED.sub(lambda match: "" if entries.fullmatch(match.group(1)) else match.group(), text)
    text = re.sub(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0", r"arg[\1][\2]", text)
    text = re.sub(r"if \(res\[(\d+)\]!=0\) res\[\1\]", r"res[\1]", text)
    assert "]? arg[" not in text
    assert "]!=0)" not in text
    return text


def entries_text(functions: Sequence[ca.Function], prefix: str) -> str:
    """The entries of functions, which the static functions prefix + "_f" + index compute."""
    sizes = sorted({shape for f in functions for side in _sides(f) for shape in side.values()})
    dense = [f"static const casadi_int mg_dense_{m}_{n}[] = {{{m}, {n}, 1}};" for m, n in sizes]
    parts = [line for index, f in enumerate(functions) for line in _entry(f, f"{prefix}_f{index}")]
    head = HEAD.format(
        longest_in=max((f.numel_in(i) for f in functions for i in range(f.n_in())), default=1),
        longest_out=max((f.numel_out(i) for f in functions for i in range(f.n_out())), default=1),
        most_in=max((f.n_in() for f in functions), default=1),
        most_out=max((f.n_out() for f in functions), default=1),
    )
    return "\n".join([head, *dense, *parts]) + "\n"


def _entry(function: ca.Function, internal: str) -> list[str]:
    lines = []
    for side, arguments in zip(("in", "out"), _sides(function), strict=True):
        names = ", ".join(f'"{name}"' for name in arguments) or "0"
        sparsities = ", ".join(f"mg_dense_{m}_{n}" for m, n in arguments.values()) or "0"
        lines.append(f"static const char *const mg_names_{side}_{internal}[] = {{{names}}};")
        lines.append(f"static const casadi_int *const mg_sparsity_{side}_{internal}[] = {{{sparsities}}};")
    return [*lines, f"MG_ENTRY({function.name()}, {internal}, {function.n_in()}, {function.n_out()})"]


def _sides(function: ca.Function) -> tuple[dict[str, tuple[int, int]], dict[str, tuple[int, int]]]:
    """Shapes of inputs and of outputs by name; all of them are dense."""
    inputs = {name: function.sparsity_in(name) for name in function.name_in()}
    outputs = {name: function.sparsity_out(name) for name in function.name_out()}
    assert all(each.is_dense() for each in (*inputs.values(), *outputs.values()))
    return {k: v.size() for k, v in inputs.items()}, {k: v.size() for k, v in outputs.items()}
