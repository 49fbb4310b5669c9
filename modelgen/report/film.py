"""A run as a film: the bodies at equal intervals of time, as GIF or MP4."""

from __future__ import annotations

from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.file_writing import replaced
from modelgen.report.body_pictures import draw_bodies
from modelgen.report.displayed_bodies import Stage
from modelgen.report.run_record import Record

RATE = 20  # pictures per s
LONGEST, SHORTEST = 6.0, 2.0  # s, of a film
SIZE, DOTS = (6.0, 4.8), 100


def draw_film(record: Record, stage: Stage, path: Path, figure: Any) -> None:
    """Write the film of a run; a short run is slowed down, a long one quickened.

    Raises ModelgenError where what writes such a film, Pillow or ffmpeg, is missing.
    """
    t = record.columns["t"]
    span = float(t[-1] - t[0]) if len(t) else 0.0
    duration = min(max(span, SHORTEST), LONGEST)
    times = np.linspace(0.0, span, max(int(duration * RATE), 2))
    samples = [int(np.abs(t - t[0] - time).argmin()) for time in times] if len(t) else []
    writer = _writer(path)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.9))
    try:
        with replaced(path) as scratch, writer.saving(figure, str(scratch), DOTS):
            for sample in samples:
                axes.clear()
                draw_bodies(axes, record, stage, sample)
                writer.grab_frame()
    except CalledProcessError as cause:
        found = f"ffmpeg cannot write it (exit code {cause.returncode})"
        raise ModelgenError(str(path), found, "", "make room there, or name another file") from None


def _writer(path: Path) -> Any:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    kind, tool = (PillowWriter, "Pillow") if path.suffix == ".gif" else (FFMpegWriter, "ffmpeg")
    if not kind.isAvailable():
        raise ModelgenError(
            str(path), f"{tool} is not there to write it", ".gif needs Pillow, .mp4 the program ffmpeg",
            f"install {tool}, or write FILE.{'mp4' if path.suffix == '.gif' else 'gif'}",
        )  # fmt: skip
    return kind(fps=RATE)
