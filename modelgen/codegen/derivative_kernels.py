"""The derivatives of the formulas of a scene as C text: tangents, adjoints, and the functions that dispatch
on task and kind (core/sensitivity)."""

from __future__ import annotations

from typing import Any

import casadi as ca

from modelgen.codegen.casadi_external_entries import internal_functions
from modelgen.differentiation import TASKS, PackedFormula

PREFIX = "mg_derivatives"
NO_DERIVATIVES = "#define MG_DERIVATIVES 0"
SCENE_TANGENT = """static void mg_scene_rhs_tangent(const mg_real *x, const mg_real *gravity,
                                 const mg_real *parameters, const mg_real *x_dot,
                                 const mg_real *gravity_dot, const mg_real *parameters_dot,
                                 mg_real *slope_dot) {{
  const mg_real *arg[] = {{x, gravity, parameters, x_dot, gravity_dot, parameters_dot}};
  mg_real *res[] = {{slope_dot}};
  {internal}(arg, res, 0, 0, 0);
}}
"""
TABLE = """static const mg_derivatives mg_derivative_table = {{
    mg_formula_tangent, {scene}, mg_formula_adjoint}};

#define MG_DERIVATIVES &mg_derivative_table
"""


def derivatives_text(formulas: tuple[PackedFormula, ...]) -> str:
    """The functions, then the table, as MG_DERIVATIVES."""
    functions = [function for each in formulas for function in (each.tangent, each.adjoint)]
    options: dict[str, Any] = {"static_aux": True, "verbose": False, "with_header": False, "prefix": PREFIX}
    generator = ca.CodeGenerator("derivatives.c", options)
    for function in functions:
        generator.add(function)
    internal = {function.name(): f"{PREFIX}_f{index}" for index, function in enumerate(functions)}
    scene = [internal[each.tangent.name()] for each in formulas if each.task == "scene"]
    parts = [
        internal_functions(str(generator.dump()), functions),
        _dispatcher(
            "mg_formula_tangent",
            "x_dot",
            "y_dot",
            [(f, internal[f.tangent.name()]) for f in formulas if f.task != "scene"],
        ),
        *(SCENE_TANGENT.format(internal=name) for name in scene),
        _dispatcher(
            "mg_formula_adjoint", "y_bar", "x_bar", [(f, internal[f.adjoint.name()]) for f in formulas]
        ),
        TABLE.format(scene="mg_scene_rhs_tangent" if scene else "0"),
    ]
    return "\n".join(parts)


def _dispatcher(name: str, given: str, result: str, cases: list[tuple[PackedFormula, str]]) -> str:
    arguments = f"int task, int kind, const mg_real *w, const mg_real *x, const mg_real *{given}"
    lines = [f"static void {name}({arguments}, mg_real *{result}) {{"]
    lines += [
        f"  const mg_real *arg[] = {{w, x, {given}}};",
        f"  mg_real *res[] = {{{result}}};",
        "  switch (task) {",
    ]
    for task in dict.fromkeys(TASKS.values()):
        own = [(each, function) for each, function in cases if each.task == task]
        if not own:
            continue
        lines += [f"    case MG_TASK_{task.upper()}:", "      switch (kind) {"]
        for each, function in own:
            lines += [
                f"        case {each.kind}: /* {each.name} */",
                f"          {function}(arg, res, 0, 0, 0);",
                "          break;",
            ]
        lines += [
            "        default: /* no kind of this scene */",
            "          break;",
            "      }",
            "      break;",
        ]
    lines += ["    default: /* no task of this scene */", "      break;", "  }", "}"]
    return "\n".join(lines) + "\n"
