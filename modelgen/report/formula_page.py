"""One HTML page: formulas, shapes, singularities and errata; no network, no scripts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from modelgen.report import mathml
from modelgen.report.formula_text_and_latex import status_text, tree
from modelgen.report.heat_map_png import colour, data_uri
from modelgen.report.html_parts import STYLE, badge, document, sections_of, table

GREEK = {"sigma": "σ", "mu": "μ", "eta": "η", "gamma": "Γ₂", "gamma1": "Γ₁", "Gamma": "Γ"}


def page(source: str, facts: Mapping[str, Any]) -> str:
    """The whole document."""
    sections = [
        ("formulas", "Formulas", "".join(map(_formula, facts["formulas"]))),
        ("shapes", "Shapes", "".join(map(_shape, facts["shapes"]))),
        ("singularities", "Singular configurations", "".join(map(_singularity, facts["singularities"]))),
        ("errata", "Errata of the paper", _errata(facts["errata"])),
    ]
    return document(source, STYLE, _opening(source) + sections_of(sections))


def _opening(source: str) -> str:
    return (
        f"<h1>{escape(source)}</h1><p>A companion to Anitescu, Cremer and Potra, <em>Formulating 3D Contact "
        "Dynamics Problems</em>. Every formula stands as it is compiled, from its definitions to what is "
        "exported, with the numbers of one configuration. <em>Proved</em>: an identity that SymPy decided. "
        "<em>Tested</em>: equal to an independent derivation on random configurations, computed for this "
        "page.</p>"
    )


def _formula(facts: Mapping[str, Any]) -> str:
    name = facts["name"] + (f": {facts['quantity']}" if facts["quantity"] else "")
    statement = f"<pre>{escape(facts['statement'])}</pre>" if facts["statement"] else ""
    count = f"{escape(facts['citation'])}; {facts['instructions']} instructions."
    text = f"{badge(facts['status'])} {escape(status_text(facts).removeprefix(facts['status']).lstrip('; '))}"
    return (
        f"<h3>{escape(name)}</h3><p>{count}</p>{statement}<p>{text}</p>{_findings(facts['findings'])}"
        f"{_ports(facts)}<p>From what is exported down to its definitions:</p>{_tree(facts['definition'])}"
    )


def _findings(findings: Sequence[Mapping[str, Any]]) -> str:
    rows = [
        (
            named(f["quantity"]),
            badge(f["status"]),
            worded(f["route"]),
            str(f["n"] or ""),
            _error(f["worst"]) if f["n"] else "",
        )
        for f in findings
    ]
    return table(("quantity", "status", "against", "N", "worst error"), rows, (3, 4)) if rows else ""


def _ports(facts: Mapping[str, Any]) -> str:
    rows = [
        (kind, named(port["name"]), "×".join(map(str, port.get("shape", ()))), indexed(port["unit"]),
         escape(port["frame"]), worded("; ".join(filter(None, (port["meaning"], port["equation"])))))
        for group, kind in (("inputs", "in"), ("outputs", "out"), ("steps", "step"))
        for port in facts[group]
        if port.get("shape") != [0]
    ]  # fmt: skip
    return table(("", "name", "shape", "unit", "frame", "meaning"), rows)


def _tree(definition: Sequence[Mapping[str, Any]]) -> str:
    """Nested by <details>, which need no script; the exported quantities are open."""
    zeros = [line["key"] for line in definition if _is_zero(line)]
    nodes = list(tree([line for line in definition if not _is_zero(line)]))
    parts: list[str] = []
    depths: list[int] = []
    for (depth, line, above), (following, _, after) in zip(nodes, [*nodes[1:], (0, {}, False)], strict=True):
        while depths and depths[-1] >= depth:
            depths.pop()
            parts.append("</details>")
        number = f' <span class="v">= {line["number"] + 0.0:.6g}</span>' if line["uses"] else ""
        label = f'<span class="eq">{line["value"]}</span>{number}'
        if above:
            more = ", " if after and following == depth else " above"
            parts.append(f'<span class="leaf v">{named(line["key"])}{more}</span>')
        elif following > depth:
            parts.append(f"<details{' open' if depth == 0 else ''}><summary>{label}</summary>")
            depths.append(depth)
        else:
            parts.append(f'<div class="leaf">{label}</div>')
    rest = f'<div class="leaf">{", ".join(map(named, zeros))} = 0</div>' if zeros else ""
    return "".join(parts) + "</details>" * len(depths) + rest


def _is_zero(line: Mapping[str, Any]) -> bool:
    """Whether a line only says that an output is zero, whatever the inputs are."""
    return not line["uses"] and line["number"] == 0


def _shape(facts: Mapping[str, Any]) -> str:
    rows = []
    for entry in facts["quantities"]:
        check = entry["check"]
        text = ""
        if check is not None:
            text = f"{badge(check['status'])} {_error(check['worst'])} on {check['n']} points"
        lines = "".join(f'<div><span class="eq">{line}</span></div>' for line in entry["mathml"])
        rows.append(f"<p>{worded(entry['meaning'])} {text}</p>{lines}")
    none = "" if rows else "<p>No closed form that could be read; the formulas above hold it.</p>"
    return f"<h3>{escape(facts['name'])}</h3>{''.join(rows)}{none}"


def _singularity(facts: Mapping[str, Any]) -> str:
    (x0, x1), (y0, y1) = facts["ranges"]
    names = [indexed(axis) for axis in facts["axes"]]
    scale = "".join(
        f'<rect x="480" y="{320 - 3 * k}" width="16" height="3" fill="rgb{colour(k / 50 - 1)}"/>'
        for k in range(101)
    )
    labels = [
        (60, 345, f"{x0:.3g}"), (425, 345, f"{x1:.3g}"), (18, 320, f"{y0:.3g}"), (18, 32, f"{y1:.3g}"),
        (502, 325, "−1"), (502, 175, "0"), (502, 28, "1"),
    ]  # fmt: skip
    style = 'font-size="13" font-family="sans-serif"'
    texts = "".join(f'<text x="{x}" y="{y}" {style}>{text}</text>' for x, y, text in labels)
    place = 'x="60" y="20" width="400" height="300" preserveAspectRatio="none"'
    image = f'<image {place} href="{data_uri(facts["mu"])}"/>'
    return (
        f"<h3>{escape(facts['kind'])}</h3><p>Singular where {indexed(facts['condition'])}.</p><figure>"
        f'<svg width="540" height="360" viewBox="0 0 540 360" role="img">{image}{scale}{texts}</svg>'
        f"<figcaption>Margin μ, from {facts['least']:.3g} to {facts['largest']:.3g}, over {names[0]} (to the "
        f"right) and {names[1]} (upwards); black: singular, red: no minimum of the distance. Held: "
        f"{escape(facts['held'])}.</figcaption></figure>"
    )


def _errata(rows: Sequence[Mapping[str, Any]]) -> str:
    cells = [
        (escape(r["equation"]), indexed(r["printed"]), indexed(r["corrected"]), escape(r["kind"]),
         indexed(r["measure"]), str(r["n"]),
         _error(r["error_printed"]), str(r["agree_printed"]), _error(r["error_corrected"]),
         str(r["agree_corrected"]), "confirmed" if r["confirmed"] else badge("failed"))
        for r in rows
    ]  # fmt: skip
    head = [
        *("equation", "as printed", "corrected", "kind", "error in"),
        *("N", "printed", "agree", "corrected", "agree", ""),
    ]
    intro = (
        "<p>Both statements of each row, evaluated for this page on random contacts, against the motion "
        "itself or the Jacobian of the extremality system: the largest error, and how many agree.</p>"
    )
    return intro + table(head, cells, (5, 6, 7, 8, 9))


def indexed(text: str) -> str:
    """`_x` as an index, `^x` as an exponent, in escaped text."""
    below = re.sub(r"_(\w+)", lambda found: f"<sub>{found[1].replace('_', ',')}</sub>", escape(text))
    return re.sub(r"\^(\w+)", r"<sup>\1</sup>", below)


def named(name: str) -> str:
    """A quantity by its symbol, as the formulas write it."""
    return mathml.block(mathml.symbol(name))


def worded(text: str) -> str:
    """Words with `x_dot` as a letter with its dot, `x_f` with its index, and Greek letters."""
    text = re.sub(r"\b(sigma|mu|eta|gamma1|gamma|Gamma)(?=\b|_)", lambda found: GREEK[found[1]], text)
    marks = {"_dot": "\u0307", "_ddot": "\u0308"}
    dotted = re.sub(r"(?<!\w)(\w)(_d?dot)\b", lambda found: found[1] + marks[found[2]], text)
    return indexed(dotted.replace("->", "→"))


def _error(value: float | None) -> str:
    return "0" if value == 0 else "not finite" if value is None else f"{value:.1e}"
