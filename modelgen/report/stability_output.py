"""Output of `linearise --vary`: eigenvalues over a parameter, and where the steady motion is stable."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from modelgen.linearisation.stability import Stability
from modelgen.linearisation.touching_contact import Array
from modelgen.report.run_files import check_suffix
from modelgen.report.run_plot import FORMATS, require_matplotlib, save_figure


def stability_facts(found: Stability) -> dict[str, Any]:
    """The object that `linearise --vary --json` prints."""
    return {
        "scene": found.scene,
        "parameter": found.parameter,
        "stable": [list(ends) for ends in found.stable],
        "values": found.values.tolist(),
        "refused": [list(each) for each in found.refused],
        "eigenvalues": [[[x.real, x.imag] for x in values.tolist()] for values in found.eigenvalues],
    }


def print_stability(facts: dict[str, Any], console: Console) -> None:
    """The same for people: a line a value, then the ranges in which no motion grows."""
    name = facts["parameter"]
    console.print(f"{facts['scene']}: eigenvalues of the steady motion, 1/s", markup=False, soft_wrap=True)
    for value, eigenvalues in zip(facts["values"], facts["eigenvalues"], strict=True):
        shown = ", ".join(_shown(*each) for each in eigenvalues if each[1] >= 0) or "no steady motion"
        console.print(f"{name} {value:.6g}: {shown}", markup=False, soft_wrap=True)
    ranges = [f"{first:.12g} to {last:.12g}" for first, last in facts["stable"]]
    text = (
        f"no motion grows for {name} from {', '.join(ranges)}" if ranges else "some motion grows everywhere"
    )
    console.print(text, markup=False, soft_wrap=True)
    for value, why in facts["refused"]:
        console.print(f"{name} {value:.6g}: {why}", markup=False, soft_wrap=True)
    if facts["plot"]:
        console.print(f"picture: {facts['plot']}", markup=False, soft_wrap=True)


def _shown(real: float, imaginary: float) -> str:
    return f"{real:.9g} +- {imaginary:.9g}i" if imaginary else f"{real:.9g}"


def draw_stability(found: Stability, path: Path) -> None:
    """Write the picture; the suffix says how (.png or .svg). Raises ModelgenError without matplotlib."""
    check_suffix(path, FORMATS)
    figure = require_matplotlib()(figsize=(8.0, 5.5), layout="constrained")
    axes = figure.add_subplot()
    for k, branch in enumerate(_branches(found)):
        axes.plot(found.values, branch.real, color="C0", label="growth, 1/s" if not k else None)
        axes.plot(
            found.values, np.where(branch.imag > 0, branch.imag, np.nan), color="C1", linewidth=0.9,
            label="frequency, rad/s" if not k else None,
        )  # fmt: skip
    for k, (first, last) in enumerate(found.stable):
        axes.axvspan(first, last, color="C2", alpha=0.15, label="no motion grows" if not k else None)
    axes.axhline(0.0, color="0.5", linewidth=0.8)
    axes.set_xlim(found.values[0], found.values[-1])
    axes.set_xlabel(found.parameter)
    axes.set_ylabel("real and imaginary parts of the eigenvalues")
    axes.set_title(f"{found.scene}: small motions about the steady motion")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    save_figure(figure, path)


def _branches(found: Stability) -> list[Array]:
    """(m,) complex each; NaN where a value has fewer eigenvalues."""
    most = max(len(values) for values in found.eigenvalues)
    padded = [np.append(values, [np.nan] * (most - len(values))) for values in found.eigenvalues]
    return list(np.array(padded).T)
