"""Pairs of a number of a scene and a time: the derivative of a run by that number up to then, beside
differences of runs with an estimate of what these resolve."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.error_estimate import nudge
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.sensitivity import Outputs, TangentRun, Verdict
from modelgen.runtime.sensitivity import Shown as Derivatives
from modelgen.runtime.sensitivity_directions import Direction, direction_arrays
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.scene.scene_from_tables import scene_from_tables
from tests.running import SCENES, copied
from tests.sensitivity.differences import MANY, differentiable

LARGEST, HALVINGS = 1e-3, 7  # change of a number, relative to its size, and how often it is halved
FEWEST = 3  # step sizes of an extrapolation
FEW = 8.0 * np.finfo(float).eps  # relative changes that are rounding: they show how rough a run is
SAFE = 10.0  # times the estimate of the error of an extrapolation
AGREES, WRONG = 1e-9, 1e-6  # relative to the size of the derivative
CURVED = 10.0  # of constraints: by how much a start leaves them, by the square of its relative change
ROUNDED = 1e-12  # sizes that are not told from zero

Tables = dict[str, Any]


@dataclass(frozen=True)
class Pair:
    """Errors, sizes and noise are those of positions, velocities and spins by the scales of the scene."""

    by: str
    t: float
    verdict: Verdict
    error: float  # largest difference from the differences; infinite where the derivative is not finite
    size: float  # of the derivative
    noise: float  # what the differences resolve; infinite where changed runs have other events
    is_held: bool = False  # differences of the scene as it says are refused or open: of a start that is held

    @property
    def outcome(self) -> str:
        """Whether differences bear the derivative out: `agrees`, `off`, `wrong`, or `unresolved`."""
        allowed = SAFE * self.noise
        if not allowed <= WRONG * self.size + AGREES:
            return "unresolved"
        if self.error <= AGREES * self.size + allowed + ROUNDED:
            return "agrees"
        return "off" if self.error <= WRONG * self.size + allowed + ROUNDED else "wrong"


# --- scenes with parameters


def with_factors(tables: Tables, paths: Sequence[Sequence[Any]]) -> Tables:
    """The tables of a scene in which the number at each path is multiplied by a parameter f0, f1, .. of the
    value 1."""
    changed: Tables = copied(tables)
    for index, (*way, last) in enumerate(paths):
        at: Any = changed
        for key in way:
            at = at[key]
        at[last] = _times(at[last], f"f{index}")
    factors = [{"name": f"f{index}", "value": 1.0} for index in range(len(paths))]
    return {**changed, "parameter": factors} if paths else changed


def _times(value: Any, factor: str) -> Any:
    return [_times(each, factor) for each in value] if isinstance(value, list) else f"{factor}*({value})"


SHAPE_NUMBERS = ("radius", "semi_axes", "size", "length", "major_radius", "minor_radius", "height")
OF_BODIES = ("mass", "density", "center_of_mass", "velocity", "angular_velocity")
OF_CONTACTS = ("friction", "restitution", "rolling_resistance", "spinning_resistance")
OF_JOINTS = ("stiffness", "damping", "rest", "limits", "restitution", "friction")


def paths_of_numbers(tables: Tables) -> Iterator[tuple[Any, ...]]:
    """Places of numbers that are worth a parameter: masses, inertia, shapes, friction, restitution, joints,
    springs, gravity."""
    if _is_number(tables.get("gravity", [None] * 3)[2]):
        yield ("gravity", 2)
    for k, body in enumerate(tables["body"]):
        if "inertia" in body:
            yield ("body", k, "inertia")
        for key in OF_BODIES:
            yield from _numbers_at(body.get(key), ("body", k, key))
        shapes = body.get("shape")
        for way, shape in [(("shape",), shapes)] if isinstance(shapes, dict) else []:
            for key in SHAPE_NUMBERS:
                yield from _numbers_at(shape.get(key), ("body", k, *way, key))
    for kind, keys in (
        ("contact", OF_CONTACTS),
        ("joint", OF_JOINTS),
        ("spring", ("stiffness", "rest_length")),
    ):
        for k, entry in enumerate(tables.get(kind, ())):
            for key in keys:
                yield from _numbers_at(entry.get(key), (kind, k, key))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value != 0


def _numbers_at(value: Any, path: tuple[Any, ...]) -> Iterator[tuple[Any, ...]]:
    if isinstance(value, dict):
        for key in ("static", "kinetic", "mu"):
            yield from _numbers_at(value.get(key), (*path, key))
    elif isinstance(value, list):
        found = [(*path, k) for k, each in enumerate(value) if _is_number(each)]
        yield from found[:1]
    elif _is_number(value):
        yield path


def tables_of(name: str) -> Tables:
    """The tables of a shipped scene, with gravity."""
    return {"gravity": [0.0, 0.0, -9.81]} | tomllib.loads((SCENES / f"{name}.toml").read_text("utf-8"))


def paths_accepted(name: str, tables: Tables) -> list[tuple[Any, ...]]:
    """Those places of numbers that the scene lets depend on a parameter."""
    accepted: list[tuple[Any, ...]] = []
    for path in paths_of_numbers(tables):
        try:
            scene_from_tables(name, with_factors(tables, [path]), f"{name}.toml")
        except ModelgenError:
            continue
        accepted.append(path)
    return accepted


def spread(paths: Sequence[tuple[Any, ...]], n: int) -> list[tuple[Any, ...]]:
    """At most n of the places, first those of keys that none before has."""
    keys = [tuple(part for part in path if isinstance(part, str)) for path in paths]
    first = [k for k, key in enumerate(keys) if key not in keys[:k]]
    order = first + [k for k in range(len(paths)) if k not in first]
    return [paths[k] for k in sorted(order[:n])]


def library_with_factors(name: str, n: int) -> tuple[Library, dict[str, str]]:
    """A shipped scene of which at most n numbers have a factor, and what these numbers are, by factor."""
    tables = tables_of(name)
    paths = spread(paths_accepted(name, tables), n)
    scene = scene_from_tables(name, with_factors(tables, paths), f"{name}.toml")
    library = differentiable(scene)
    named = {f"f{k}": ".".join(map(str, path)) for k, path in enumerate(paths)}
    return library, {factor: meaning for factor, meaning in named.items() if _may_change(library, factor)}


def _may_change(library: Library, factor: str) -> bool:
    """Whether other values of a factor keep what is compiled."""
    try:
        for change in (LARGEST, -LARGEST):
            with_parameters(library, {factor: 1.0 + change})
    except ModelgenError:
        return False
    return True


# --- runs and their differences


def scales_of(library: Library) -> tuple[list[str], Array]:
    """What of a run is looked at, and the size of each component."""
    instance = library.manifest.instance
    moving = [body for body in instance["bodies"] if body["motion"] in ("free", "point")]
    length, time = instance["scales"]["length"], instance["scales"]["time"]
    sizes = {"position": length, "velocity": length / time, "angular_velocity": 1 / time}
    of = [
        (f"{body['name']}.{quantity}", size)
        for quantity, size in sizes.items()
        for body in moving
        if quantity != "angular_velocity" or body["motion"] == "free"
    ]
    return [name for name, _ in of], np.repeat([size for _, size in of], 3)


def unit_of(library: Library, direction: Direction) -> float:
    """The size of the number of a direction."""
    scales = library.manifest.instance["scales"]
    length, time = scales["length"], scales["time"]
    return {
        "position": length, "velocity": length / time, "orientation": 1.0, "angular_velocity": 1 / time
    }.get(direction.quantity, 1.0)  # fmt: skip


def size_of(library: Library, direction: Direction) -> float:
    entries = [*library.manifest.instance["parameters"], *library.manifest.instance["inputs"]]
    for entry in entries if direction.kind != "start" else ():
        if entry["name"] == direction.owner:
            return abs(float(entry["value" if "value" in entry else "default"])) or 1.0
    return unit_of(library, direction)


def opened(library: Library, reach: float = 0.0) -> Session:
    """A run at `tight`. A start that leaves its constraints by less than `reach` L is put back on them."""
    session = Session(library, accuracy_of(library.manifest.instance, "tight", {}))
    for name in ("start_gap", "start_joint_gap"):
        setattr(session.settings, name, max(float(getattr(session.settings, name)), reach))
    return session


@dataclass(frozen=True)
class Shown:
    """Values of a run at each time, and the contacts and events that it had up to then."""

    values: Array  # (nt, n_of)
    history: tuple[object, ...]


def shown(session: Session, times: Sequence[float], of: list[str], scales: Array) -> Shown:
    """Advance a run from its start."""
    begin(session)
    outputs, record = Outputs(session, of), session.tables.Record()
    values, history = [], []
    told: list[object] = [*map(int, session.closed), *((e.kind, e.contact) for e in session.drain_events())]
    for t in times:
        code = FULL
        while code in (CONTINUE, FULL):
            code = session.advance(t, MANY, record)
            told += [(event.kind, event.contact) for event in session.drain_events()]
        values.append(outputs.values(session) / scales if not code else np.full(len(scales), np.nan))
        history.append(tuple(told))
    return Shown(np.array(values), tuple(history))


def changed_run(
    library: Library, direction: Direction, along: Array | None, change: float, times: Sequence[float],
    of: list[str], scales: Array,
) -> Shown | None:  # fmt: skip
    """A run with a change along a direction, `along` being that of its settled start, or where it is None
    from the start that the scene says; None where it is refused."""
    reach = 0.0 if along is None else CURVED * (change / size_of(library, direction)) ** 2
    try:
        if direction.kind == "parameter":
            values = {each["name"]: each["value"] for each in library.manifest.instance["parameters"]}
            session = opened(
                with_parameters(library, {direction.owner: values[direction.owner] + change}), reach
            )
        else:
            session = opened(library, reach)
        if along is not None:
            session.x[:] = library_start(library) + change * along
        if direction.kind == "input":
            Inputs(session)[direction.owner] += change
        for body in session.instance["bodies"]:
            if body["motion"] == "free":
                quaternion = session.x[body["q"] + 3 : body["q"] + 7]
                quaternion /= np.linalg.norm(quaternion)
        return shown(session, times, of, scales)
    except ModelgenError:
        return None


def library_start(library: Library) -> Array:
    """The state at the start, settled."""
    session = opened(library)
    begin(session)
    return session.x.copy()


class Pairs:
    """Pairs of the numbers of a scene with some times."""

    def __init__(self, library: Library, times: Sequence[float], accuracy: str = "tight") -> None:
        """`accuracy`: of the derivatives; differences are those of runs at `tight`."""
        self.library, self.times, self._accuracy = library, list(times), accuracy
        self._of, self._scales = scales_of(library)
        self._plain = shown(opened(library), times, self._of, self._scales)
        nudged = opened(library)
        nudge(nudged.x, nudged.instance)
        self._nudged = (shown(nudged, times, self._of, self._scales),)
        self._rough: dict[str, list[float]] = {}

    def of(self, direction: Direction) -> Iterator[Pair]:
        """The pairs of one number."""
        size = size_of(self.library, direction)
        found, along = self._derivatives(direction)
        steps = [LARGEST * size / 2**k for k in range(HALVINGS)]
        runs, is_held = self._changed(direction, along, steps)
        for index, t in enumerate(self.times):
            _, jacobian, _, verdict = found[index]
            exact = jacobian[:, 0] / self._scales * size
            quotients = self._quotients(runs, steps, index)
            if len(quotients) < FEWEST or not np.all(np.isfinite(exact)):
                yield Pair(direction.name, t, verdict, np.inf, float(np.max(np.abs(exact))), np.inf)
                continue
            rough = self._roughness(direction, along, size, index)
            value, noise = extrapolated_with_noise(
                [quotient * size for quotient in quotients],
                [rough * size / step for step in steps[-len(quotients) :]],
            )
            error = float(np.max(np.abs(exact - value)))
            yield Pair(direction.name, t, verdict, error, float(np.max(np.abs(value))), noise, is_held)

    def _derivatives(self, direction: Direction) -> tuple[list[Derivatives], Array]:
        """What `TangentRun.shown` says at each time, and the change of the settled start."""
        arrays = direction_arrays(self.library, [direction])
        record = accuracy_of(self.library.manifest.instance, self._accuracy, {})
        run = TangentRun(Session(self.library, record), arrays, 1)
        along, outputs = run.state_derivatives()[0].copy(), Outputs(run.session, self._of)
        return [run.go_on(float(t)).shown(outputs) for t in self.times], along

    def _changed(
        self, direction: Direction, along: Array, steps: Sequence[float]
    ) -> tuple[list[tuple[Shown | None, Shown | None]], bool]:
        """Runs with each step, forth and back. A start that is held is changed as far as that permits. And
        whether the scene with another number starts elsewhere, so that its start is held as well."""
        runs: list[tuple[Shown | None, Shown | None]] = []
        for way in [along] if direction.kind == "start" else [None, along]:
            runs = []
            for step in reversed(steps):
                up, down = (
                    changed_run(self.library, direction, way, change, self.times, self._of, self._scales)
                    for change in (step, -step)
                )
                runs.insert(0, (up, down))
                if not self._alike((up, down), 0):
                    break
            else:
                break
        return runs, direction.kind != "start" and way is not None

    def _roughness(self, direction: Direction, along: Array, size: float, index: int) -> float:
        """By how much changes by rounding change what a run shows at a time."""
        if direction.name not in self._rough:
            way = along if direction.kind == "start" else None
            runs = [
                changed_run(self.library, direction, way, change, self.times, self._of, self._scales)
                for change in (FEW * size, -FEW * size)
            ]
            self._rough[direction.name] = [
                max(
                    float(np.max(np.abs(run.values[k] - self._plain.values[k])))
                    for run in (*runs, *self._nudged)
                    if run is not None
                )
                for k in range(len(self.times))
            ]
        return self._rough[direction.name][index]

    def _alike(self, both: tuple[Shown | None, Shown | None], index: int) -> bool:
        """Whether changed runs have the events of the plain one, up to a time."""
        history = self._plain.history[index]
        return all(each is not None and each.history[index] == history for each in both)

    def _quotients(
        self, runs: Sequence[tuple[Shown | None, Shown | None]], steps: Sequence[float], index: int
    ) -> list[Array]:
        """Central differences at a time, of those smaller steps whose runs have the plain events."""
        found: list[Array] = []
        for both, step in zip(reversed(runs), reversed(steps), strict=False):
            up, down = both
            if up is None or down is None or not self._alike(both, index):
                break
            found.insert(0, (up.values[index] - down.values[index]) / (2 * step))
        return found


def extrapolated_with_noise(quotients: Sequence[Array], rough: Sequence[float]) -> tuple[Array, float]:
    """Of central differences with steps h, h/2, ..: the entry of the table of extrapolations to h = 0 that is
    nearest to those it comes from, and how near that is (Ridders, Advances in Engineering Software 4 (1982),
    75-76), at least as far as rounding moves the differences."""
    table = [[quotients[0]]]
    best, noise = quotients[0], np.inf
    for k in range(1, len(quotients)):
        row = [quotients[k]]
        for order in range(1, k + 1):
            factor = 4.0**order
            row.append((factor * row[-1] - table[-1][order - 1]) / (factor - 1))
            apart = max(
                float(np.max(np.abs(row[order] - row[order - 1]))),
                float(np.max(np.abs(row[order] - table[-1][order - 1]))),
                rough[k],
            )
            if apart < noise:
                best, noise = row[order], apart
        table.append(row)
    return best, noise
