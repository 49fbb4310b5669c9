"""The formulas of a model: source, inputs and outputs, cost, and how each is computed."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import casadi as ca
import sympy as sp

from modelgen.codegen.emit import emit
from modelgen.codegen.manifest import Manifest
from modelgen.codegen.manifest_model import parameters_of_joint
from modelgen.contact.form_table import FORMS, contact_kernels
from modelgen.contact.tangential_rows import with_tangential_rows
from modelgen.derivation import Derivation, Formula
from modelgen.errors import ModelgenError
from modelgen.joint.joint_equations import FORMS as FORMS_OF_JOINTS
from modelgen.joint.joint_kernels import coordinates_kernel, rows_kernel
from modelgen.model import Model
from modelgen.name_suggestions import nearest
from modelgen.notation import notation
from modelgen.report import mathml
from modelgen.report.formula_text_and_latex import symbol_latex
from modelgen.report.inputs_at_closest_points import ClosestInputs
from modelgen.verification.formula_inputs import Numbers, inputs_at, own_inputs, substituted
from modelgen.verification.sympy_translation import LONGEST, Line, definition, leading_to
from modelgen.verification.verify import (
    OF_CONTACTS,
    claimed,
    is_of_joint,
    is_of_limit,
    joint_kind,
    verified,
)


@dataclass(frozen=True)
class View:
    """Additions to a formula: numbers at one configuration, and a status computed on n others."""

    seed: int = 0
    given: Mapping[str, Any] = field(default_factory=dict)
    n: int = 0
    closest: ClosestInputs | None = None  # searches the closest points of a given configuration

    def inputs(self, formula: Formula, derivation: Derivation) -> Numbers:
        """The value of each input of a formula."""
        found = inputs_at(formula, derivation, self.seed, self.given)
        return (
            self.closest.completed(formula, found, own_inputs(formula, self.given)) if self.closest else found
        )

    def verdict(self, formula: Formula, derivation: Derivation) -> dict[str, Any]:
        """The status; `unchecked` are outputs that no finding is about."""
        if not self.n:
            return {**claimed(formula, derivation.model).as_dict(), "unchecked": []}
        verdict = verified(formula, derivation, self.n, self.seed).as_dict()
        found = {finding["quantity"] for finding in verdict["findings"]}
        known = {*found, *(("J_o", "J_f") if "J" in found else ())}
        sized = [name for k, name in enumerate(formula.function.name_out()) if formula.function.numel_out(k)]
        return {**verdict, "unchecked": [name for name in sized if name not in known]}


Format = Literal["text", "latex", "html"]
GROUPS = {
    **dict.fromkeys(("motion", "energy", "path"), "body"),
    **dict.fromkeys(("rates", "place", "angle"), "contact"),
    "surface": "shape",
    "curve": "shape",
    "point": "shape",
    "rows": "joint",
    "coordinates": "joint",
}  # of the manifest's kinds, by the role of a formula
NARROW = 14  # operations in one line of a page
OF_A_PAIR = ("surface", "curve", "point", "rates", "place", "angle")  # roles that a pair of shapes decides
OF_JOINTS: Mapping[str, Mapping[str, str]] = {  # what the names of bodies and contacts mean for a joint
    "parameters": {
        "meaning": "origin c and rotation Q of both frames, axes of the bodies; the length; the joint's own"
    }
}
_ANGLE = {"meaning": "angle of the joint, whole turns counted", "unit": "rad", "frame": "", "equation": ""}
OF_A_LIMIT: Mapping[str, Mapping[str, str]] = {  # what the names of a contact mean for a limit of a joint
    **OF_JOINTS,
    "eta": _ANGLE,
    "eta_next": {**_ANGLE, "meaning": "the angle of the poses nearest to eta"},
    "eta_dot": {**_ANGLE, "meaning": "its rate", "unit": "rad/s"},
    "d": {"meaning": "how far the coordinate is from its bound, angles times the length", "equation": ""},
    "gamma": {"meaning": "second derivative of d without accelerations", "equation": "(2.6)"},
    "normal": {"meaning": "z axis of the first frame, reversed for the upper bound", "equation": ""},
    "residual": {"meaning": "0, and how far eta was off, rad", "equation": ""},
    "point_o": {"meaning": "origin of the first frame", "equation": ""},
    "point_f": {"meaning": "origin of the second frame", "equation": ""},
}
OF_A_JOINT = ("rows", "coordinates", "rates", "place", "wrench", "deflection")


def formula_facts(
    derivation: Derivation,
    name: str | None,
    style: Format,
    roles: Sequence[str] = (),
    view: View | None = None,
) -> list[dict[str, Any]]:
    """The formulas of a derivation: the `formulas` of `inspect --json`.

    Args:
        derivation: what `derive` returned.
        name: of a formula, of a role such as "rates", or of a quantity such as "gamma", which is then
            written with what leads to it and nothing else; all formulas when None.
        style: how expressions are written.
        roles: the roles to show when there is no name, and without coaxial supports; all when empty.
        view: where numbers are substituted, and how often formulas are verified.

    Raises ModelgenError if nothing has that name.
    """
    manifest, view = emit(derivation).manifest, view or View()
    of_supports = _kinds_of_supports(derivation.model)
    found = []
    for formula in derivation.formulas:
        if roles and formula.role in OF_CONTACTS and formula.kind in of_supports:
            continue
        whole = name in (None, formula.name, formula.role) and (name or not roles or formula.role in roles)
        function, steps = _written_out(formula, derivation.model)
        if whole or name in function.name_out():
            names = _parameter_names(formula, derivation.model, manifest)
            inputs = view.inputs(formula, derivation)
            lines = definition(function, names, steps, NARROW if style == "html" else LONGEST)
            numbers = dict(zip(lines, substituted(lines, inputs, names), strict=True))
            facts = _facts(formula, derivation.model, manifest, numbers, None if whole else name, style)
            found.append({**facts, "at": inputs, **view.verdict(formula, derivation)})
    if not found:
        raise _unknown(str(name), derivation)
    return found


def _kinds_of_supports(model: Model) -> set[int]:
    """The kinds of contact that coaxial supports alone have."""
    kinds: dict[bool, set[int]] = {True: set(), False: set()}
    for each in model.feature_pairs:
        kinds[each.is_coaxial_support].add(each.kind)
    return kinds[True] - kinds[False]


def _unknown(name: str, derivation: Derivation) -> ModelgenError:
    formulas = [formula.name for formula in derivation.formulas]
    functions = [_written_out(formula, derivation.model)[0] for formula in derivation.formulas]
    outputs = list(dict.fromkeys(out for function in functions for out in function.name_out()))
    allowed = f"formulas are {', '.join(formulas)}; quantities are {', '.join(outputs)}"
    found = f"no formula and no quantity named {name!r}"
    return ModelgenError("inspect", found, allowed, nearest(name, [*formulas, *outputs]))


def _written_out(formula: Formula, model: Model) -> tuple[ca.Function, tuple[str, ...]]:
    """The function that is written, and those of its outputs that are steps on the way to the others."""
    if formula.role != "rates" or is_of_limit(formula, model):
        return formula.function, ()
    function = contact_kernels(model.contact_kinds[formula.kind]).steps
    known = formula.function.name_out()
    return function, tuple(name for name in function.name_out() if name not in known)


def _facts(
    formula: Formula,
    model: Model,
    manifest: Manifest,
    numbers: Mapping[Line, float],
    only: str | None,
    style: Format,
) -> dict[str, Any]:
    """One formula, or `only` one quantity of it."""
    entry = {**manifest.functions, **manifest.composed}[formula.name]
    written = list(numbers) if only is None else leading_to(list(numbers), only)
    kernel_outputs = [port["name"] for port in entry["outputs"]]
    steps = dict.fromkeys(line.output for line in written if line.output not in ("", *kernel_outputs))
    outputs = [port for port in entry["outputs"] if only in (None, port["name"])]
    own = OF_A_LIMIT if is_of_limit(formula, model) else OF_JOINTS if is_of_joint(formula, model) else {}
    return {
        "name": formula.name,
        "role": formula.role,
        "quantity": only or "",
        "citation": formula.citation,
        "statement": statement_of(formula, model),
        "inputs": [{**_explained(port), **own.get(port["name"], {})} for port in entry["inputs"]],
        "outputs": [{**_explained(port), **own.get(port["name"], {})} for port in outputs],
        "steps": [_explained({"name": name, "unit": notation(name).unit}) for name in steps],
        "instructions": formula.instructions,
        "definition": [_line(line, numbers[line], style) for line in written],
    }


def _explained(port: Mapping[str, Any]) -> dict[str, Any]:
    """A port of the manifest with what the dictionary of names says of it."""
    entry = notation(port["name"])
    return {**port, "meaning": entry.meaning, "frame": entry.frame, "equation": entry.equation}


def _line(line: Line, number: float, style: Format) -> dict[str, Any]:
    """Name and value as written, the number, and what the value is made of."""
    uses = sorted(
        map(str, line.value.free_symbols), key=lambda name: (name.rstrip("0123456789"), len(name), name)
    )
    known = {"number": number, "key": str(line.target), "uses": uses}
    if style == "text":
        return {"name": str(line.target), "value": sp.sstr(line.value), **known}
    if style == "html":
        return {
            "name": str(line.target),
            "value": mathml.equation(mathml.symbol(str(line.target)), line.value),
            **known,
        }
    symbols = {symbol: symbol_latex(str(symbol)) for symbol in line.value.free_symbols}
    return {
        "name": symbol_latex(str(line.target)),
        "value": sp.latex(line.value, symbol_names=symbols, mul_symbol=r" \, "),
        **known,
    }


def statement_of(formula: Formula, model: Model) -> str:
    """What a joint or the form of a contact states, in the words of its own docstring."""
    if formula.role in ("rows", "coordinates"):
        kernel = rows_kernel if formula.role == "rows" else coordinates_kernel
        keeps = FORMS_OF_JOINTS[model.joint_kinds[formula.kind].kind].keeps
        return f"{keeps}.\n\n{inspect.getdoc(kernel) or ''}"
    if formula.role not in ("rates", "place", "angle") or is_of_limit(formula, model):
        return ""
    kind = model.contact_kinds[formula.kind]
    form = FORMS[kind.form]
    stated = inspect.getdoc(form.angle if formula.role == "angle" else form.build) or ""
    if formula.role == "rates" and kind.rows > 1:
        return f"{stated}\n\n{inspect.getdoc(with_tangential_rows)}"
    return stated


def _parameter_names(formula: Formula, model: Model, manifest: Manifest) -> dict[str, list[str]]:
    """The names of the entries of `parameters`: `a_o` of `o.a`; with owners in the composed function."""
    kinds = manifest.kinds
    if formula.role == "rhs":
        entries = [("body", body.kind, body.name) for body in model.bodies]
        entries += [
            ("contact", feature_pair.kind, model.pairs[feature_pair.pair].name)
            for feature_pair in model.feature_pairs
        ]
        owned = [
            f"{_identifier(name)}_{re.sub(r'[^A-Za-z0-9]+', '_', owner)}"
            for group, kind, owner in entries
            for name in _listed(kinds[group][kind])
        ]
        loads = sum(len(load.parameters) for load in model.loads)
        return {"parameters": [*owned, *(f"load_{i + 1}" for i in range(loads))]}
    if is_of_joint(formula, model):
        names = {"parameters": list(map(_of_frames, parameters_of_joint(joint_kind(formula, model))))}
        if "J" in formula.function.name_out():
            rows = range(1, formula.function.numel_out("J") // 12 + 1)
            names["J"] = [f"J_{row}_{side}_{k}" for row in rows for side in "ab" for k in range(1, 7)]
        return names
    if formula.role not in GROUPS:
        return {}
    return {"parameters": list(map(_identifier, _listed(kinds[GROUPS[formula.role]][formula.kind])))}


def _of_frames(name: str) -> str:
    """`a.R_xx` is `Q_a_xx`, `a.p_x` is `c_a_x`: the poses of the bodies have the letters R and p."""
    side, _, rest = name.partition(".")
    letter, _, axes = rest.partition("_")
    return f"{'Q' if letter == 'R' else 'c'}_{side}_{axes}" if rest else name


def _listed(kind: Mapping[str, Any]) -> list[str]:
    return [] if "folded" in kind else list(kind["parameters"])


def _identifier(name: str) -> str:
    return "_".join(reversed(name.split(".")))
