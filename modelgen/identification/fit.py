"""Fit numbers of a scene to recorded motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.identification.compared_columns import comparison_of
from modelgen.identification.confidence import Confidence, confidence_of, lag_correlation, repetition
from modelgen.identification.least_squares import LOSSES, Attempt, Solution, solve
from modelgen.identification.measurement_noise import noise_of
from modelgen.identification.recording_files import read_recording
from modelgen.identification.recording_residuals import Counts, RecordedRun, RecordedRuns
from modelgen.identification.recording_starts import start_of
from modelgen.identification.recordings import Array, Recording, recording_of
from modelgen.identification.unidentifiable_in_words import in_words
from modelgen.identification.unknowns import Unknown, unknowns_of
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import (
    check_function,
    check_keywords,
    check_name,
    check_whole,
    names_in,
    values_by_name,
    with_parameters,
)
from modelgen.runtime.by_name import ByName
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of

KEYWORDS = (
    *("data", "by", "of", "start", "noise", "parameters", "inputs", "loss", "starts", "seed", "evaluations"),
    *("accuracy", "on_progress", *STEPPING),
)
CLOSE = 0.95  # correlation of two unknowns that is told
MISFIT = 2.0  # deviations over the noise given, root mean square, that are told
FAINT = 0.1  # deviations over the noise, root mean square, that are no deviations
FOLLOWING = 0.3  # correlation of deviations with those of the row before that is told
AT_BOUND = 1e-6  # distance to the end of a range, in scales

Data = str | PathLike[str] | Mapping[str, Any] | Recording


@dataclass(frozen=True)
class Residuals:
    """What is left of a recording."""

    name: str
    t: Array  # (nt,)
    of: tuple[str, ...]  # names of the deviations
    groups: tuple[str, ...]  # the quantity of each
    deviations: Array  # (nt, n) run minus recording; NaN where nothing was measured
    rms: dict[str, float]  # by quantity


@dataclass(frozen=True)
class Fit:
    """Numbers of a scene that were fitted, with their confidence."""

    scene: str
    names: tuple[str, ...]  # "friction"; of a start with several recordings: "ball.velocity_x of FILE"
    values: Array  # (n,) of an orientation: the turn from the first guess, rad, body axes
    first: Array  # (n,)
    confidence: Confidence
    unseen: tuple[str, ...]  # what the data cannot tell, in words
    notes: tuple[str, ...]  # what limits the result, in words
    noise: dict[str, float]  # by column or quantity, as given or estimated
    residuals: tuple[Residuals, ...]
    starts: tuple[dict[str, list[float]], ...]  # of the bodies in each recording
    counts: Counts  # of derivatives, of the whole fit
    counts_at_solution: Counts
    attempts: tuple[Attempt, ...]
    simulated: int  # runs
    converged: bool
    message: str
    parameters: dict[str, float]  # fitted
    inputs: dict[str, float]  # fitted

    def __getitem__(self, name: str) -> float:
        """The value of an unknown."""
        check_name("fit", name, self.names)
        return float(self.values[self.names.index(name)])

    def interval(self, name: str) -> tuple[float, float]:
        """Its confidence interval, of 95 %."""
        value, half = self[name], float(self.confidence.half_width[self.names.index(name)])
        return value - half, value + half


def fit(
    library: Library,
    data: Data | Sequence[Data],
    *,
    by: Sequence[str],
    of: Sequence[str] | None = None,
    start: Sequence[str] = (),
    noise: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    loss: str = "linear",
    starts: int = 1,
    seed: int = 0,
    evaluations: int = 100,
    accuracy: Accuracy | str | None = None,
    on_progress: Callable[[str], None] | None = None,
    **stepping: Unpack[Stepping],
) -> Fit:
    """Fit parameters, inputs and starts of a scene to recorded motion, by nonlinear least squares.

    Args:
        library: what `build(emit(derivation, derivatives=True))` returned.
        data: CSV files, or columns by name: "t", s, ascending from the start of the run at 0 on; sensors and
            their components; "ball.position_x" and so on of bodies (`sensitivity` lists what there is).
            Several recordings are runs of their own. "start", in a file comments `# start ball.velocity =
            1, 0, 0`, has quantities of bodies at t = 0: fixed, or first guesses of what is in `by`.
        by: parameters and inputs by name, common to all recordings; starts of bodies, whole
            ("ball.velocity") or by component ("ball.velocity_x"), of each recording.
        of: columns that count, by name or quantity; all when None.
        start: bodies that start as a recording shows, by its first rows, in place of the scene's start.
        noise: standard deviations by column or quantity ("ball.position"); estimated for others, one a
            quantity.
        parameters, inputs: values; of those in `by` the first guess.
        loss: "linear", or one that counts outliers less: "huber", "soft_l1", "cauchy".
        starts: first guesses, of which all but one are drawn from the ranges of the unknowns, by `seed`.
        evaluations: most residuals of one minimisation.
        accuracy, stepping: as those of `start`.
        on_progress: told in words what goes on.

    Raises:
        ModelgenError: data or an argument is not what it says, there are fewer numbers than unknowns, or the
            run of every first guess is refused or ends early.
    """
    expect("fit", library, Library)
    check_keywords("fit", stepping, KEYWORDS)
    check_name("loss", loss, LOSSES)
    starts, evaluations = check_whole("starts", starts, ""), check_whole("evaluations", evaluations, "")
    seed = check_whole("seed", seed, "", 0)
    check_function("on_progress", on_progress)
    of = None if of is None else names_in("of", of)
    given = values_by_name("inputs", inputs)
    library = with_parameters(library, parameters)
    recordings = _recordings(data, of)
    unknowns = unknowns_of(library.manifest.instance, by, len(recordings), given)
    chosen, unknowns = _recorded_runs(library, recordings, unknowns, names_in("start", start))
    accuracy = accuracy_of(library.manifest.instance, accuracy, stepping)
    runs = RecordedRuns(library, accuracy, chosen, unknowns, given)
    first_noise = noise_of(chosen, noise)
    _check_size(recordings, chosen, unknowns)
    found = solve(runs, first_noise, loss, starts, seed, evaluations, on_progress or _silent)
    return _result(runs, found, loss)


def _silent(_: str) -> None:
    """Tells nobody."""


def _recordings(data: Data | Sequence[Data], of: Sequence[str] | None) -> list[Recording]:
    several = [data] if isinstance(data, str | PathLike | Mapping | Recording) else data
    if not isinstance(several, Sequence):
        raise SimulationError("data", f"a {type(data).__name__}", "CSV files, or columns by name")
    if not several:
        raise SimulationError("data", "no recordings", "CSV files, or columns by name")
    found = []
    for k, each in enumerate(several):
        if isinstance(each, Recording):
            found.append(each)
        elif isinstance(each, Mapping):
            found.append(recording_of(each, f"recording {k + 1}", of))
        elif isinstance(each, str | PathLike):
            found.append(recording_in(Path(each), of))
        else:
            raise SimulationError("data", f"a {type(each).__name__}", "CSV files, or columns by name")
    return found


def recording_in(path: Path, of: Sequence[str] | None) -> Recording:
    """The recording in a CSV file, of which these columns count; raises SimulationError."""
    try:
        return read_recording(path, of)
    except OSError as cause:
        raise SimulationError(
            str(path), f"cannot be read: {cause.strerror}", "", "name a CSV file"
        ) from cause


def _recorded_runs(
    library: Library, recordings: Sequence[Recording], unknowns: Sequence[Unknown], bodies: Sequence[str]
) -> tuple[list[RecordedRun], list[Unknown]]:
    """The run of each recording, and all unknowns with their first guesses."""
    found = [each for each in unknowns if each.recording < 0]
    runs = []
    for k, recording in enumerate(recordings):
        comparison = comparison_of(library.manifest.instance, recording)
        own = [each for each in unknowns if each.recording == k]
        start, guessed = start_of(library, recording, own, bodies)
        parts = tuple(range(len(found), len(found) + len(guessed)))
        found += guessed
        runs.append(RecordedRun(recording, comparison, start, parts))
    return runs, found


def _check_size(
    recordings: Sequence[Recording], runs: Sequence[RecordedRun], unknowns: Sequence[Unknown]
) -> None:
    """Raise SimulationError where a recording, or all, have fewer numbers than unknowns."""
    counts = [int(np.isfinite(each.values).sum()) for each in recordings]
    for recording, run, count in zip(recordings, runs, counts, strict=True):
        if count < len(run.parts):
            raise _too_few(recording.name, count, len(run.parts))
    if sum(counts) <= len(unknowns):
        raise _too_few("data", sum(counts), len(unknowns))


def _too_few(where: str, count: int, unknowns: int) -> SimulationError:
    found = f"{count} measured numbers for {unknowns} unknowns"
    return SimulationError(where, found, "more numbers than unknowns", "fit fewer, or record more")


def _result(runs: RecordedRuns, found: Solution, loss: str) -> Fit:
    weights = [1 / found.noise.of(run) for run in runs.runs]
    masks = [np.isfinite(part) for part in found.deviations]
    residual = np.concatenate(
        [(part * w)[mask] for part, w, mask in zip(found.deviations, weights, masks, strict=True)]
    )
    jacobian = np.concatenate(
        [(part * w[:, None])[mask] for part, w, mask in zip(found.derivatives, weights, masks, strict=True)]
    )
    common = np.array([each.recording < 0 for each in runs.unknowns])
    relative = common & (found.x != 0)
    scales = np.where(relative, np.abs(found.x), runs.scales)
    following = lag_correlation(
        [column for part, w in zip(found.deviations, weights, strict=True) for column in (part * w).T]
    )
    slopes, repeated = slopes_of(residual, loss), repetition(following, len(residual))
    confidence = confidence_of(jacobian, residual, slopes, scales, found.noise.is_given, repeated)
    names = _names(runs)
    unseen = tuple(in_words(each, names, relative.tolist()) for each in confidence.unseen)
    fitted = {
        kind: ByName(
            {
                runs.unknowns[k].name: float(found.x[k])
                for k in runs.common
                if runs.unknowns[k].direction.kind == kind
            },
            kind,
        )
        for kind in ("parameter", "input")
    }
    return Fit(
        scene=str(runs.library.manifest.instance["name"]),
        names=names,
        values=found.x,
        first=np.array([each.first for each in runs.unknowns]),
        confidence=confidence,
        unseen=unseen,
        notes=tuple(_notes(runs, found, confidence, names, residual, following)),
        noise=_noise_told(runs, found),
        residuals=tuple(_residuals(run, part) for run, part in zip(runs.runs, found.deviations, strict=True)),
        starts=tuple(runs.starts(run, found.x) for run in runs.runs),
        counts=found.all_counts,
        counts_at_solution=found.counts,
        attempts=tuple(found.attempts),
        simulated=runs.simulated,
        converged=found.converged,
        message=found.message,
        parameters=fitted["parameter"],
        inputs=fitted["input"],
    )


def slopes_of(residual: Array, loss: str) -> Array:
    """(m,) derivative of the loss by the squared deviation over noise: 1 for the linear one."""
    z = (residual / LOSSES[loss]) ** 2
    if loss == "huber":
        return np.asarray(np.where(z <= 1, 1.0, 1 / np.sqrt(np.maximum(z, 1.0))))
    if loss == "soft_l1":
        return np.asarray(1 / np.sqrt(1 + z))
    return np.asarray(1 / (1 + z)) if loss == "cauchy" else np.ones_like(z)


def _names(runs: RecordedRuns) -> tuple[str, ...]:
    several = len(runs.runs) > 1
    return tuple(
        f"{each.name} of {runs.runs[each.recording].recording.name}"
        if several and each.recording >= 0
        else each.name
        for each in runs.unknowns
    )


def _noise_told(runs: RecordedRuns, found: Solution) -> dict[str, float]:
    told: dict[str, float] = ByName({}, "noise")
    for run in runs.runs:
        for name, group, size in zip(
            run.comparison.names, run.comparison.groups, found.noise.of(run), strict=True
        ):
            told[name if name in found.noise.given else group] = float(size)
    return told


def _residuals(run: RecordedRun, deviations: Array) -> Residuals:
    groups = run.comparison.groups
    rms = {
        group: float(
            np.sqrt(np.nanmean(deviations[:, [k for k, each in enumerate(groups) if each == group]] ** 2))
        )
        for group in dict.fromkeys(groups)
    }
    return Residuals(
        run.recording.name, run.recording.t, run.comparison.names, groups, deviations, ByName(rms, "quantity")
    )


def _notes(
    runs: RecordedRuns,
    found: Solution,
    confidence: Confidence,
    names: Sequence[str],
    residual: Array,
    following: float,
) -> list[str]:
    told = [] if found.converged else [f"the fit did not converge: {found.message}"]
    for name, unknown, x in zip(names, runs.unknowns, found.x, strict=True):
        for end, word in ((unknown.low, "least"), (unknown.high, "largest")):
            if abs(x - end) <= AT_BOUND * unknown.scale:
                told.append(f"{name} is at its {word} value, {end:.6g}; its interval does not know of that")
    size = len(names)
    told += [
        f"{names[j]} and {names[k]} are hard to tell apart: correlation {confidence.correlation[j, k]:+.3f}"
        for j in range(size)
        for k in range(j + 1, size)
        if abs(confidence.correlation[j, k]) > CLOSE and runs.unknowns[j].recording < 0
    ]
    misfit = float(np.sqrt(np.mean(residual**2)))
    if found.noise.given and misfit > MISFIT:
        told.append(
            f"deviations are {misfit:.3g} times the noise: the scene leaves something out; intervals are "
            "widened"
        )
    if following > FOLLOWING and misfit > FAINT:
        told.append(
            f"deviations follow each other (correlation {following:.2f} from row to row): the scene leaves "
            "something out; intervals are widened as for fewer rows"
        )
    counts = found.counts
    unsure = counts.confirmed + counts.differences + counts.kept
    if unsure:
        reasons = sorted(counts.reasons, key=lambda reason: -counts.reasons[reason])
        told.append(
            f"derivatives are not certain in {unsure} of {unsure + counts.certain} rows "
            f"({'; '.join(reasons)}): {counts.confirmed} agree with differences of runs, "
            f"{counts.differences} are such differences, "
            f"{counts.kept} are kept, because differences say less"
        )
    return told
