"""The formulas of a model as text or LaTeX: source, inputs and outputs, cost, and how each is computed."""

from __future__ import annotations

import inspect
from typing import Any, Literal

import sympy as sp

from modelgen.codegen.emit import emit
from modelgen.codegen.manifest import Manifest
from modelgen.contact.kinds import FORMS
from modelgen.derive import Derivation, Formula
from modelgen.errors import ModelgenError, nearest
from modelgen.model import Model
from modelgen.report.symbolic import definition
from modelgen.scene.shapes import SHAPES
from modelgen.scene.types import Body, ContactPair, Scene, Shape

Format = Literal["text", "latex"]
GROUPS = {
    **dict.fromkeys(("motion", "energy", "path"), "body"),
    **dict.fromkeys(("rates", "place"), "contact"),
    "surface": "shape",
}  # of the manifest's kinds, by the role of a formula


def formula_facts(derivation: Derivation, name: str | None, style: Format) -> list[dict[str, Any]]:
    """All formulas of a derivation, or the named one: the `formulas` of `inspect --json`.

    Raises ModelgenError if no formula has that name.
    """
    names = [formula.name for formula in derivation.formulas]
    if name is not None and name not in names:
        remedy = nearest(name, names) or f"known are {', '.join(names)}"
        raise ModelgenError("inspect", f"no formula named {name!r}", "", remedy)
    manifest = emit(derivation).manifest
    return [
        _facts(formula, derivation.model, manifest, style)
        for formula in derivation.formulas
        if name in (None, formula.name)
    ]


def _facts(formula: Formula, model: Model, manifest: Manifest, style: Format) -> dict[str, Any]:
    entry = manifest.functions.get(formula.name, {})
    lines = definition(formula.function, _parameter_names(formula, manifest.kinds))
    write = sp.latex if style == "latex" else sp.sstr
    return {
        "name": formula.name,
        "role": formula.role,
        "citation": formula.citation,
        "statement": _statement(formula, model),
        "inputs": entry.get("inputs") or _ports(formula, output=False),
        "outputs": entry.get("outputs") or _ports(formula, output=True),
        "instructions": formula.function.n_instructions(),
        "definition": [{"name": write(line.target), "value": write(line.value)} for line in lines],
    }


def _ports(formula: Formula, *, output: bool) -> list[dict[str, Any]]:
    """Names and shapes of a function that is not compiled and so has no entry in the manifest."""
    f = formula.function
    if output:
        return [{"name": f.name_out(i), "shape": list(f.size_out(i))} for i in range(f.n_out())]
    return [{"name": f.name_in(i), "shape": list(f.size_in(i))} for i in range(f.n_in())]


def _statement(formula: Formula, model: Model) -> str:
    """What the form of a contact states, in the words of its own docstring."""
    if formula.role not in ("rates", "place"):
        return ""
    return inspect.getdoc(FORMS[model.contact_kinds[formula.kind].form].build) or ""


def _parameter_names(formula: Formula, kinds: dict[str, Any]) -> dict[str, list[str]]:
    """The names of the entries of `parameters`, where the manifest lists them: `a_o` of `o.a`."""
    group = GROUPS.get(formula.role)
    if group is None:
        return {}
    kind = kinds[group][formula.kind]
    written = [] if kind.get("folded") is not None else kind["parameters"]
    return {"parameters": ["_".join(reversed(name.split("."))) for name in written]}


def formula_text(facts: dict[str, Any], style: Format) -> str:
    """One formula as it is printed: a heading, inputs and outputs with units, then its lines."""
    comment = "%" if style == "latex" else "#"
    heads = [f"{facts['name']}: {facts['citation']}", f"{facts['instructions']} instructions"]
    heads += [f"{way[:-1]} {_port(port)}" for way in ("inputs", "outputs") for port in facts[way]]
    heads += facts["statement"].splitlines()
    head = "\n".join(f"{comment} {line}".rstrip() for line in heads)
    if style == "text":
        return "\n".join((head, *(f"{line['name']} = {line['value']}" for line in facts["definition"])))
    rows = " \\\\\n".join(f"{line['name']} &= {line['value']}" for line in facts["definition"])
    return f"{head}\n\\begin{{align*}}\n{rows}\n\\end{{align*}}"


def _port(port: dict[str, Any]) -> str:
    shape = port["shape"]
    sizes = "x".join(str(n) for n in shape) if isinstance(shape, list | tuple) else str(shape)
    return f"{port['name']} ({sizes}) {port.get('unit', '')}".rstrip()


def kind_scene(kind: str) -> Scene:
    """A scene with one contact of the kind "shape-shape" or "shape-shape:form", both bodies free.

    The lengths in it are arbitrary: they are parameters of the formulas.
    """
    pair, _, form = kind.partition(":")
    shapes = pair.split("-")
    if len(shapes) != 2 or not all(shape in SHAPES for shape in shapes):
        unknown = next((shape for shape in shapes if shape not in SHAPES), kind)
        allowed = f"a scene file, or SHAPE-SHAPE or SHAPE-SHAPE:FORM with shapes {', '.join(SHAPES)}"
        raise ModelgenError("inspect", f"no kind {kind!r}", allowed, nearest(unknown, SHAPES))
    if form and form not in FORMS:
        raise ModelgenError(
            "inspect", f"no form {form!r}", f"forms: {', '.join(FORMS)}", nearest(form, FORMS)
        )
    bodies = tuple(_sample_body(name, shape) for name, shape in zip("of", shapes, strict=True))
    between = (("o", "shape"), ("f", "shape"))
    return Scene(kind, "inspect", bodies, (ContactPair(between, form=form or "auto"),))


def _sample_body(name: str, shape: str) -> Body:
    names = SHAPES[shape].parameters
    parameters = tuple((parameter, float(len(names) + 1 - i)) for i, parameter in enumerate(names))
    inertia = ((3.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 5.0))
    return Body(name, "dynamic", (Shape(shape, parameters),), mass=1.0, inertia=inertia)
