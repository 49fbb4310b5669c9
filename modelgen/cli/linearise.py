"""The command `linearise`: small motions about an equilibrium or a steady motion, and ranges of stability."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from rich.console import Console

import modelgen
from modelgen.cli.command import Option
from modelgen.cli.option_reading import named_values, read_values
from modelgen.cli.options import AsJson, Form, SceneFile, Values
from modelgen.cli.output import check_outputs, print_facts
from modelgen.cli.pipeline import linearise_scene
from modelgen.errors import ModelgenError

Steady = Annotated[bool, Option("--steady", help="about the steady motion near the start")]
Vary = Annotated[
    str | None,
    Option(
        help="eigenvalues of the steady motion over a parameter, and where it is stable",
        metavar="NAME=a:b:n",
    ),
]
Plot = Annotated[
    Path | None,
    Option(help="with --vary: draw them to FILE.png or FILE.svg", metavar="FILE"),
]


def linearise(
    scene: SceneFile,
    steady: Steady = False,
    vary: Vary = None,
    plot: Plot = None,
    form: Form = None,
    values: Values = None,
    as_json: AsJson = False,
) -> None:
    """Find the equilibrium or steady motion near the start of a scene; print frequencies, growth rates and
    shapes of the small motions about it."""
    from modelgen.parameter_study.design import design_points, variations_of
    from modelgen.report import linearisation_output as output
    from modelgen.report.stability_output import draw_stability, print_stability, stability_facts

    given = read_values(values, "--set")
    if vary is None:
        if plot is not None:
            raise ModelgenError("--plot", "no --vary", "it draws eigenvalues over a parameter", "add --vary")
        if steady:
            motion = linearise_scene(
                scene, form, lambda *made: modelgen.linearise_steady(*made[:2], parameters=given)
            )
            facts, show = output.steady_facts(motion), output.print_steady
        else:
            rest = linearise_scene(scene, form, lambda *made: modelgen.linearise(*made[:2], parameters=given))
            facts, show = output.mode_facts(rest), output.print_modes
        print_facts(facts, as_json, lambda: show(facts, Console()))
        return
    check_outputs(None, plot)
    (varied,) = variations_of(named_values([vary], "--vary", "speed=0:10:101"))
    _, points = design_points((varied,), None, "grid", 0)
    numbers = sorted(points[:, 0].tolist())

    def find(*made: Any) -> Any:
        derivation, library, report = made
        return modelgen.stability(
            derivation,
            library,
            varied.name,
            numbers,
            parameters=given,
            on_progress=report,
        )

    found = linearise_scene(scene, form, find)
    if plot is not None:
        draw_stability(found, plot)
    facts = stability_facts(found) | {"plot": None if plot is None else str(plot)}
    print_facts(facts, as_json, lambda: print_stability(facts, Console()))
