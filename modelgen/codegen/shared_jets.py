"""Jets of shapes as C functions of their own, which the kernels of a shape call.

A kernel of CasADi computes the jets of its shapes, point and derivatives, by itself. Where a jet is long, it
is most of each kernel, and a compiler works on it once in each. The C text has it once; results are the same
to the last bit.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import compress
from typing import TypeVar

import casadi as ca

from modelgen.composition.casadi_instructions import instructions, rebuilt, unsimplified
from modelgen.contact.form_table import eta_layout
from modelgen.derivation import Formula
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.frames import POSE_SIZE
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.geometry.surface_kernel import shape_parameters
from modelgen.model import ContactKind, Model, ShapeKind
from modelgen.notation import ETA_SIZE

KERNEL = """
static int {name}(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {{
  casadi_real jets[{size}];
  const casadi_real *given[] = {{{given}, jets}};
{calls}
  return {name}_of_jets(given, res, iw, w, mem);
}}
"""
CALL = """  {{
    const casadi_real *at[] = {{{at}, {parameters}}};
    casadi_real *numbers[] = {{jets + {start}}};
    {jet}(at, numbers, iw, w, mem);
  }}"""
Matrix = TypeVar("Matrix", ca.SX, ca.DM)
LEAST = 200  # instructions that a kernel loses by its calls; a call costs some tens


@dataclass(frozen=True)
class JetCall:
    """The call of a jet; each of its arguments is an argument of the kernel, from an entry on."""

    jet: ca.Function  # (coordinates, parameters) -> its numbers
    coordinates: tuple[int, int]
    parameters: tuple[int, int]

    def values(self, arguments: Sequence[Matrix]) -> Matrix:
        """The jet at arguments of the kernel."""
        places = (self.coordinates, self.parameters)
        given = [arguments[k][start:] for k, start in places]
        return self.jet(*(each[: self.jet.numel_in(i)] for i, each in enumerate(given)))


@dataclass(frozen=True)
class SharedKernel:
    """A kernel without its jets, whose numbers it takes as one more argument."""

    rest: ca.Function
    calls: tuple[JetCall, ...]


def shared_kernels(model: Model, formulas: Sequence[Formula]) -> Mapping[str, SharedKernel]:
    """The kernels that call jets, by name; the others stay whole."""
    found: dict[str, SharedKernel] = {}
    for formula in formulas:
        calls = _jet_calls(model, formula)
        shared = _without_jets(formula.function, calls) if calls else None
        if shared and formula.instructions - shared.rest.n_instructions() >= LEAST:
            found[formula.name] = shared
    users = Counter(call.jet.name() for shared in found.values() for call in shared.calls)
    return {
        name: shared
        for name, shared in found.items()
        if any(users[call.jet.name()] > 1 for call in shared.calls)
    }


@cache
def jet_function(kind: ShapeKind) -> ca.Function:
    """`mg_<kind>_jet`: (coordinates, parameters) -> point, first and second derivatives of a shape."""
    argument, parameters = shape_parameters(kind)
    at = ca.SX.sym("at", 1 if is_curve(kind) else 2)
    jet = (curve_of(kind) if is_curve(kind) else surface_of(kind)).jet(at, parameters)
    numbers = ca.vertcat(*(ca.vec(ca.densify(each)) for each in (jet.x, jet.first, jet.second)))
    return ca.Function(f"mg_{kind.name}_jet", [at, argument], ca.cse([numbers]))


def with_calls(text: str, kernels: Mapping[int, SharedKernel], jets: Mapping[str, int]) -> str:
    """CasADi's C text of kernels without their jets, with kernels that call the jets and then these.

    Args:
        text: in which `casadi_f<index>` is a function.
        kernels: by their indices.
        jets: their indices, by name.
    """
    for index, kernel in kernels.items():
        name = f"casadi_f{index}"
        text, count = re.subn(
            rf"^static int {name}\(", f"static int {name}_of_jets(", text, flags=re.MULTILINE
        )
        assert count == 1, name
        given = [f"arg[{k}]" for k in range(kernel.rest.n_in() - 1)]
        calls, start = [], 0
        for call in kernel.calls:
            at, parameters = (
                f"arg[{k}] + {first}" if call.jet.numel_in(i) else "0"
                for i, (k, first) in enumerate((call.coordinates, call.parameters))
            )
            calls.append(
                CALL.format(at=at, parameters=parameters, start=start, jet=f"casadi_f{jets[call.jet.name()]}")
            )
            start += call.jet.numel_out(0)
        text += KERNEL.format(name=name, size=start, given=", ".join(given), calls="\n".join(calls))
    return text


def _jet_calls(model: Model, formula: Formula) -> tuple[JetCall, ...]:
    """The calls of long jets that a kernel can make."""
    calls: Iterable[JetCall] = ()
    if formula.role in ("surface", "curve"):
        calls = [JetCall(jet_function(model.shape_kinds[formula.kind]), (0, 0), (1, 0))]
    elif formula.role in ("rates", "place") and formula.kind < len(model.contact_kinds):
        calls = _calls_of_contact(model.contact_kinds[formula.kind], formula.function.name_in())
    return tuple(call for call in calls if call.jet.n_instructions() >= LEAST)


def _calls_of_contact(kind: ContactKind, names: Sequence[str]) -> Iterator[JetCall]:
    place = first = 0
    for side, layout in zip((kind.o, kind.f), eta_layout(kind), strict=True):
        if layout in ("chart", "curve"):
            arguments = (names.index("eta"), place), (names.index("parameters"), first)
            yield JetCall(jet_function(side.shape), *arguments)
        place += ETA_SIZE[layout]
        first += shape_parameters(side.shape)[0].numel() + (POSE_SIZE if side.placement == "general" else 0)


def _without_jets(kernel: ca.Function, calls: tuple[JetCall, ...]) -> SharedKernel:
    """The kernel in which symbols take the place of what the calls compute."""
    inputs = kernel.sx_in()
    with unsimplified():
        computed = [call.values(inputs) for call in calls]
        together = ca.Function("together", inputs, ca.cse([ca.vertcat(*computed), *kernel.call(inputs)]))
        symbols = [ca.SX.sym("jet", each.numel()) for each in computed]
        numbers = ca.vertcat(*symbols)
        steps = tuple(instructions(together))
        computing = {each.number for each in steps if each.operands}
        known = {
            each.operands[0]: numbers[each.place[1]]
            for each in steps
            if each.operation == ca.OP_OUTPUT and each.place[0] == 0 and each.operands[0] in computing
        }
        _, *outputs = rebuilt(together, steps, inputs, known=known)
        needed = [any(ca.which_depends(ca.veccat(*outputs), each, 1, True)) for each in symbols]
        jets = ca.vertcat(ca.SX(0, 1), *compress(symbols, needed))
        return SharedKernel(
            ca.Function(kernel.name(), [*inputs, jets], outputs), tuple(compress(calls, needed))
        )
