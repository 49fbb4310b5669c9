"""A formula as it is printed: text, or LaTeX for amsmath."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from textwrap import indent
from typing import Any

from modelgen.notation import NAMES

GREEK = ("rho", "omega", "tau")
GROUPS = (("inputs", "inputs"), ("outputs", "outputs"), ("steps", "steps on the way"))
SPECIAL = {
    "\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}",
    "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}",
    **{mark: f"\\{mark}" for mark in "_{}&%#$"},
}  # fmt: skip


def formula_text(facts: Mapping[str, Any]) -> str:
    """Heading, source and cost; inputs, outputs and steps with units, frames and meaning; the lines."""
    title = facts["name"] + (f", {facts['quantity']} alone" if facts["quantity"] else "")
    parts = [
        title,
        f"  source: {facts['citation']}",
        f"  cost: {_cost(facts)}",
        f"  status: {status_text(facts)}",
    ]
    parts += _columns(_findings(facts)) if facts["findings"] else []
    if facts["statement"]:
        parts += ["  statement:", indent(facts["statement"], "    ")]
    for key, heading in GROUPS:
        rows = [_port_row(port) for port in facts[key] if _is_there(port)]
        if rows:
            parts += [f"  {heading}:", *_columns(rows)]
    width = max((len(line["name"]) for line in facts["definition"]), default=0)
    lines = [
        f"    {line['name']:<{width}} = {line['value']}  [{line['number']:.6g}]"
        for line in facts["definition"]
    ]
    return "\n".join((*parts, "  definition: [its number at the configuration]", *lines, *_tree(facts)))


def tree(definition: Sequence[Mapping[str, Any]]) -> Iterator[tuple[int, Mapping[str, Any], bool]]:
    """(depth, line, whether it stands above already) from each exported quantity down to what defines it."""
    lines = {line["key"]: line for line in definition}
    used = {name for line in definition for name in line["uses"]}
    seen: set[str] = set()
    waiting = [(0, line) for line in reversed(definition) if line["key"] not in used]
    while waiting:
        depth, line = waiting.pop()
        above = line["key"] in seen
        yield depth, line, above
        seen.add(line["key"])
        if not above:
            waiting += [(depth + 1, lines[name]) for name in reversed(line["uses"]) if name in lines]


def _tree(facts: Mapping[str, Any]) -> list[str]:
    rows = [
        f"    {'  ' * depth}{line['key']}{' (above)' if above else ''}"
        for depth, line, above in tree(facts["definition"])
    ]
    return ["  tree, from what is exported to what defines it:", *rows]


def status_text(facts: Mapping[str, Any]) -> str:
    """`tested on 100 configurations, worst relative error 2e-14`."""
    if not facts["findings"]:
        return str(facts["status"])
    text = str(facts["status"]).upper() if facts["status"] == "failed" else str(facts["status"])
    if facts["configurations"]:
        text += (
            f"; on {facts['configurations']} configurations, worst relative error {facts['worst'] or 0:.2g}"
        )
    return text + (f"; not compared: {', '.join(facts['unchecked'])}" if facts["unchecked"] else "")


def _findings(facts: Mapping[str, Any]) -> list[tuple[str, ...]]:
    return [
        (found["quantity"], found["status"], f"{found['worst']:.1e}" if found["n"] else "", found["route"])
        for found in facts["findings"]
    ]


def formula_latex(facts: Mapping[str, Any]) -> str:
    """The same as a section of a LaTeX document that loads amsmath."""
    title = r"\texttt{" + escape(facts["name"]) + "}"
    if facts["quantity"]:
        title += ": $" + symbol_latex(facts["quantity"]) + "$"
    parts = [
        rf"\subsection*{{{title}}}",
        rf"{escape(facts['citation'])}; {_cost(facts)}. Status: {escape(status_text(facts))}.",
    ]
    if facts["statement"]:
        parts += [r"\begin{verbatim}", facts["statement"], r"\end{verbatim}"]
    for key, heading in GROUPS:
        rows = [_port_row(port) for port in facts[key] if _is_there(port)]
        if rows:
            parts += [rf"\paragraph{{{heading.capitalize()}}}\mbox{{}}\\", _table(rows)]
    lines = " \\\\\n".join(
        f"{line['name']} &= {line['value']} = {_latex_number(line['number'])}" for line in facts["definition"]
    )
    return "\n".join((*parts, r"{\allowdisplaybreaks\begin{align*}", lines, r"\end{align*}}"))


def _latex_number(value: float) -> str:
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    return mantissa + (rf" \cdot 10^{{{int(exponent)}}}" if exponent else "")


STYLES: Mapping[str, Callable[[Mapping[str, Any]], str]] = {"text": formula_text, "latex": formula_latex}


def symbol_latex(name: str) -> str:
    """A name of the definition as a symbol: `omega_f_z` is \\omega_{f,z}; known names as in the notation.

    >>> symbol_latex("omega_f_z"), symbol_latex("normal_x"), symbol_latex("mass"), symbol_latex("s12")
    ('\\\\omega_{f,z}', 'N_{x}', '\\\\mathrm{mass}', 's_{12}')
    """
    parts = name.split("_")
    for size in range(len(parts), 0, -1):
        known = NAMES.get("_".join(parts[:size]))
        if known and len(known.name) > 1 and known.symbol and "(" not in known.symbol:
            side = [parts[size - 1]] if size > 1 and parts[size - 1] in ("o", "f") else []
            return _indexed(known.symbol, [*side, *parts[size:]])
    stem, digits = re.fullmatch(r"(.*?)(\d*)", parts[0]).groups()  # type: ignore[union-attr]
    letters = stem.removesuffix("dot")
    written = f"\\{letters}" if letters in GREEK else letters
    if len(letters) > 1 and letters not in GREEK:
        written = rf"\mathrm{{{letters}}}"
    return _indexed(rf"\dot{{{written}}}" if letters != stem else written, [digits, *parts[1:]])


def _indexed(symbol: str, indices: Sequence[str]) -> str:
    written = ",".join(_index(index) for index in indices if index)
    if not written:
        return symbol
    return (f"{{{symbol}}}" if "_" in symbol else symbol) + f"_{{{written}}}"


def _index(text: str) -> str:
    return text if len(text) < 3 else rf"\mathrm{{{text}}}"


def escape(text: str) -> str:
    """Text with the characters that mean something to LaTeX written out."""
    return "".join(SPECIAL.get(character, character) for character in text)


def _cost(facts: Mapping[str, Any]) -> str:
    return f"{facts['instructions']} instructions" + (" for all outputs" if facts["quantity"] else "")


def _is_there(port: Mapping[str, Any]) -> bool:
    return port.get("shape") != [0]


def _port_row(port: Mapping[str, Any]) -> tuple[str, ...]:
    size = "x".join(map(str, port["shape"])) if "shape" in port else ""
    meaning = port["meaning"] + (f"; {port['equation']}" if port["equation"] else "")
    return port["name"], size, port["unit"], port["frame"], meaning


def _columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["    " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]


def _table(rows: Sequence[tuple[str, ...]]) -> str:
    lines = [
        f"${symbol_latex(name)}$ & " + " & ".join(map(escape, (name, *rest))) + r" \\" for name, *rest in rows
    ]
    return "\n".join((r"\begin{tabular}{llllp{0.2\linewidth}p{0.4\linewidth}}", *lines, r"\end{tabular}"))
