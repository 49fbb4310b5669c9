"""The command that finds numbers of a scene from recorded motion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click
from rich.console import Console

from modelgen.cli.command import Argument, Option
from modelgen.cli.option_reading import read_option, read_values
from modelgen.cli.options import AsJson, InputValues, OutPicture, Quality, SceneFile, Tolerance, Values
from modelgen.cli.output import FAILED, check_outputs, print_facts
from modelgen.cli.pipeline import fit_scene
from modelgen.cli.run_options import accuracy_of

Recordings = Annotated[
    list[Path],
    Argument(
        metavar="DATA.csv...",
        help="recordings: t, and components of sensors or bodies",
    ),
]
By = Annotated[
    str | None,
    Option(
        help="what is fitted: parameters, inputs, starts such as ball.velocity or ball.velocity_x",
        metavar="A,B,...",
    ),
]
Of = Annotated[
    str | None,
    Option(help="columns that count, by name or quantity; default: all", metavar="A,B,..."),
]
Shown = Annotated[
    str | None,
    Option(help="bodies that start as each recording shows, not as the scene says", metavar="A,B,..."),
]
NoiseValues = Annotated[
    list[str] | None,
    Option(
        "--noise",
        help="standard deviation of a column or quantity; default: estimated; repeat it",
        metavar="NAME=NUMBER",
    ),
]
Loss = Annotated[str, Option(help="how deviations count", metavar="[linear|soft_l1|huber|cauchy]")]
Guesses = Annotated[str | None, Option("--starts", help="number of first guesses", metavar="NUMBER")]
Seed = Annotated[str | None, Option(help="of first guesses", metavar="NUMBER")]


def fit(
    scene: SceneFile,
    data: Recordings,
    by: By = None,
    of: Of = None,
    start: Shown = None,
    noise: NoiseValues = None,
    loss: Loss = "linear",
    starts: Guesses = None,
    seed: Seed = None,
    accuracy: Quality = None,
    tolerance: Tolerance = None,
    values: Values = None,
    inputs: InputValues = None,
    plot: OutPicture = None,
    as_json: AsJson = False,
) -> None:
    """Find parameters, inputs and starts of a scene from recorded motion, with their confidence."""
    from modelgen.report.fit_output import fit_facts, print_fit

    check_outputs(None, plot)
    found = fit_scene(
        scene,
        data,
        {
            "by": _listed(by),
            "of": None if of is None else _listed(of),
            "start": _listed(start),
            "noise": read_values(noise, "--noise"),
            "loss": loss,
            "starts": read_option("starts", starts) or 1,
            "seed": read_option("seed", seed) or 0,
            "accuracy": accuracy_of(accuracy, tolerance),
            "parameters": read_values(values, "--set"),
            "inputs": read_values(inputs, "--input"),
        },
    )
    if plot is not None:
        from modelgen.report.fit_residual_plot import draw_fit

        draw_fit(found, plot)
    facts = fit_facts(found) | {"plot": None if plot is None else str(plot)}
    print_facts(facts, as_json, lambda: print_fit(facts, Console()))
    if not found.converged:
        raise click.exceptions.Exit(FAILED)


def _listed(names: str | None) -> list[str]:
    """The names of an option that is written A,B."""
    return [name.strip() for name in (names or "").split(",") if name.strip()]
