"""A step of the classical Runge-Kutta method with the composed right-hand side of a scene, in C.

Sizes are numbers in the text and a small right-hand side becomes part of it, so that the states of the stages
stay in registers and what depends on parameters alone is computed once a step. Instructions are scheduled
over all stages: what follows from orientations can run while the forces of the stage before are computed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import casadi as ca

MOST_INLINED = 250  # instructions; copies of a larger one cost the compiler much, which `fold` asks for
TEXT = """MG_SCHEDULED static void scene_step(const mg_real *t, const mg_real *x, mg_real h,
                                    const mg_real *gravity, const mg_real *parameters,
                                    const mg_real *slope, mg_real *force, mg_real *end) {{
  const mg_real half = h / 2, sixth = h / 6;
  mg_real at[{size}], k[4][{size}];
  if (slope) {{
{first}
  }} else {{
{stages[0]}
  }}
{stages[1]}
{stages[2]}
{stages[3]}
{finish}
  (void)t, (void)gravity, (void)parameters;
}}
"""
STAGE = """{move}
  {{
    const mg_real *arg[] = {{{given}}};
    mg_real *res[] = {{{wanted}}};
    {internal}(arg, res, 0, 0, 0);
  }}"""
END = "end[{i}] = x[{i}] + sixth * (k[0][{i}] + 2 * (k[1][{i}] + k[2][{i}]) + k[3][{i}]);"


def scene_step_text(rhs: ca.Function, internal: str) -> str:
    """`scene_step` of kernels.h over the static function that computes the composed right-hand side."""
    size = sum(int(rhs.numel_in(name)) for name in ("q", "u", "eta"))
    stages = [_stage(rhs, internal, 0, "x", "")]
    for stage, span in enumerate(("half", "half", "h"), start=1):
        move = _each(size, f"at[{{i}}] = x[{{i}}] + {span} * k[{stage - 1}][{{i}}];")
        stages.append(_stage(rhs, internal, stage, "at", move))
    first = _each(size, "k[0][{i}] = slope[{i}];")
    return TEXT.format(size=size, first=first, stages=stages, finish=_each(size, END))


def _stage(rhs: ca.Function, internal: str, stage: int, at: str, move: str) -> str:
    """The slope k[stage] and the forces at a stage, at the state `at`, after `move` has written that."""
    q, u = (int(rhs.numel_in(name)) for name in ("q", "u"))
    places = {"q": at, "u": f"{at} + {q}", "eta": f"{at} + {q + u}"}
    results = {"qdot": f"k[{stage}]", "udot": f"k[{stage}] + {q}", "eta_dot": f"k[{stage}] + {q + u}"}
    results["force"] = f"force + {int(rhs.numel_out('force')) * stage}"
    given = ", ".join(places.get(name, name) if rhs.numel_in(name) else "0" for name in rhs.name_in())
    wanted = ", ".join(results[name] if rhs.numel_out(name) else "0" for name in rhs.name_out())
    return STAGE.format(move=move, given=given, wanted=wanted, internal=internal)


def _each(size: int, statement: str) -> str:
    """A statement for each number of a state; not all compilers unroll a loop over them."""
    return "\n".join("  " + statement.format(i=i) for i in range(size))


def inlined(text: str, functions: Iterable[str]) -> str:
    """C text in which these static functions become part of those that call them."""
    for name in functions:
        text, count = re.subn(rf"^static int {name}\(", f"MG_INLINE int {name}(", text, flags=re.MULTILINE)
        assert count == 1, name
    return text
