"""The command `plot`: pictures of a run or of a sweep."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from modelgen.cli.command import Argument, Option
from modelgen.cli.option_reading import read_option
from modelgen.cli.options import AsJson, Frames
from modelgen.cli.output import check_outputs, exit_with, needed, print_facts, print_lines
from modelgen.cli.sweep import Of, plot_sweep
from modelgen.cli.view import recorded
from modelgen.errors import ModelgenError


def plot(
    source: Annotated[
        Path,
        Argument(
            metavar="RUN.npz|SCENE|SWEEP",
            help="a run, a scene to run first, a folder of a sweep",
        ),
    ],
    out: Annotated[
        Path | None,
        Option(
            "--out",
            "-o",
            help="FILE.png or FILE.svg, needed; FILE.gif or FILE.mp4: a film",
            metavar="FILE",
        ),
    ] = None,
    frames: Frames = None,
    of: Of = None,
    as_json: AsJson = False,
) -> None:
    """Draw motion, forces, gaps, energy, the contact curves on both surfaces, and the bodies; or the outcomes
    of a sweep."""
    out = needed(out, "run.png")
    if source.is_dir():
        if frames is not None:
            raise ModelgenError("--frames", repr(frames), "pictures of the bodies of a run", "leave it out")
        plot_sweep(source, out, of, as_json)
        return
    from modelgen.report.run_plot import draw
    from modelgen.report.summary import written_line

    check_outputs(None, out)
    if of is not None:
        raise ModelgenError("--of", repr(of), "columns of a sweep", "leave it out for a run")
    pictures = read_option("frames", frames)
    record, trajectory = recorded(source, {})
    draw(record, out, pictures)
    facts = {"file": str(out), "scene": record.summary["scene"], "outcome": record.summary["outcome"]}
    print_facts(facts, as_json, lambda: print_lines([written_line(out)]))
    if trajectory:
        exit_with(trajectory)
