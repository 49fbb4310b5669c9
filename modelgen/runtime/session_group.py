"""Many runs of one library that go on together, in as many threads as are wanted."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.notation import SETTING_SIZE
from modelgen.runtime import checkpoint
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import check_whole
from modelgen.runtime.core_session import FULL, MANY, Session
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.lane_arrays import each_once, field_of, lanes_of, rows_of_lanes
from modelgen.runtime.settings import accuracy_without_scene
from modelgen.runtime.solver_choice import raise_failure, with_solver
from modelgen.runtime.start import REFUSED, refusal
from modelgen.runtime.tables.ctypes_structures import EVENT_ARRAYS, INTEGER, Array, address, settings_of
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Event, Outcome

SHORT_S = 0.05  # of an advance during which Ctrl-C need not be heard
LANE = "run {lane}, "  # how the error of a start says which of the lanes it is


class _Scratch:
    """Scratch memory of a thread."""

    def __init__(self, session: Session) -> None:
        self._kept = np.zeros(len(session.work), session.tables.dtype), np.zeros(len(session.iwork), INTEGER)
        self.addresses = tuple(address(array) for array in self._kept)


class SessionGroup:
    """The states of n runs, the lanes, in the core's memory. Arrays are by lane and change as runs advance.

    A lane depends on no other: it does bit for bit what a `Session` does, in any number of threads. One that
    fails stays where it is, and the others go on.

    Attributes:
        n: number of lanes.
        x: (n, n_x) state as in `Session.x`. Before `begin`: the starts, that of the scene unless overwritten.
        t: (n,) s. Before `begin`: the times of the starts, 0 unless overwritten.
        codes: (n,) outcome of the core: 0 where a lane can go on, 10 and more where it failed.
        arrays: all arrays of the runs, (n, length) each, by their names in mg_run (modelgen.h).
        accuracies: n records, by lane.
        like: a session of the library, with the names and sizes of its runs.
        runs: the n mg_run.
    """

    def __init__(
        self,
        library: Library,
        accuracy: Accuracy | str | None = None,
        *,
        n: int,
        systems: Sequence[Any] | None = None,
        accuracies: Sequence[Accuracy] | None = None,
    ) -> None:
        """`accuracy`: as for `simulate`, `balanced` when None; `systems`: n entries, the mg_system of each
        lane, of the sizes of the library's, whose arrays the caller keeps; None: that of the library.
        `accuracies`: n entries, the record of each lane, in place of `accuracy`.

        Raises ModelgenError where an argument is not what it says.
        """
        expect("SessionGroup", library, Library)
        self.n = check_whole("n", n, "give the number of runs")
        self.library = library
        common = accuracy_without_scene(library.manifest.instance, accuracy)
        self.accuracies = [common] * self.n if accuracies is None else list(accuracies)
        self._check_count("accuracies", self.accuracies)
        self.like = Session(library, self.accuracies[0])
        self._system_of = [self.like.system] * self.n if systems is None else list(systems)
        self._check_count("systems", self._system_of)
        self._settings_of = each_once(
            lambda own: with_solver(
                settings_of(self.like.tables, own, library.manifest.instance), own, library
            ),
            self.accuracies,
        )
        self.runs, self.arrays = lanes_of(self.like, self.n)
        self.x = self.arrays["x"]
        self.x[:] = self.like.x
        self.t = field_of(self.runs, "t", self.like.tables.dtype)[:, 0]
        self.codes = np.zeros(self.n, dtype=INTEGER)
        self._ends = np.zeros(self.n, dtype=self.like.tables.dtype)
        self._systems = (ctypes.c_void_p * self.n)(*map(ctypes.addressof, self._system_of))
        self._settings = (ctypes.c_void_p * self.n)(*map(ctypes.addressof, self._settings_of))
        self._columns, self._lists = self._event_lists()
        self._systems_at, self._settings_at, self._runs_at, self._lists_at = map(
            ctypes.addressof, (self._systems, self._settings, self.runs, self._lists)
        )
        self.sensed = np.zeros((self.n, self.like.shared.n_sensor), self.like.tables.dtype)
        self._sensed_at, self._codes_at, self._ends_at = map(address, (self.sensed, self.codes, self._ends))
        self._short_calls = ctypes.PyDLL(None, handle=library.cdll._handle)  # they keep Python's lock
        self._told: list[list[Event]] = [[] for _ in range(self.n)]
        self._scratch: list[_Scratch] = []
        self._cost = np.inf  # s that the last advance took for a second of its runs
        self._pool: ThreadPoolExecutor | None = None
        self._pool_size = 0

    @property
    def outcomes(self) -> tuple[Outcome | None, ...]:
        """DONE where a lane can go on, else why it ended; None where it could not start."""
        return tuple(OUTCOME_OF_CODE.get(code) for code in self.codes.tolist())

    def begin(self, threads: int = 1, label: str = LANE) -> dict[int, SimulationError]:
        """Settle the starts; returns the errors of the lanes that cannot start, by lane, which they tell by
        `label`. They are left out from then on."""
        is_long = self.n >= MANY or self.like.may_take_long
        self._share("mg_begin_many", (self._codes_at, self._lists_at), threads, is_long)
        return self.refusals(label)

    def advance(self, t: float | Array, threads: int = 1) -> None:
        """Go on to t, s, one time or one for each lane, on several threads. A lane at or past it, and one
        that has failed, is left as it is. `codes` and `outcomes` say what became of each.

        Ctrl-C ends it soon; the lanes stay where they came, and can go on.

        Raises SimulationError where an argument is not what it says.
        """
        try:
            self._ends[:] = t
        except (TypeError, ValueError):
            raise SimulationError("t", f"shape {np.shape(t)}", f"one time or {self.n}, in s", "") from None
        if not np.isfinite(self._ends).all():
            raise SimulationError("t", "not finite", "times in s", "")
        by_lane = self._ends_at, self._codes_at, self._lists_at
        span, begun = float(np.max(self._ends - self.t)), perf_counter()
        is_long = not self._cost * span < SHORT_S
        self._share("mg_advance_many", by_lane, threads, is_long)
        if span > 0:
            self._cost = (perf_counter() - begun) / span
        while (full := np.flatnonzero(self.codes == FULL)).size:
            for lane in full.tolist():
                self._told[lane] = self.drain_events(lane)
            self._share("mg_advance_many", by_lane, threads, is_long)

    def begin_again(self, lane: int, start: Array) -> None:
        """Put a lane at a start (n_x,) at t = 0 and settle it; its inputs stay. Its events are dropped.

        Raises SimulationError where the start is refused; the lane is left out from then on.
        """
        settings = self.arrays["input"][lane].copy()
        for name, array in self.arrays.items():
            array[lane] = -1 if name == "feature_pair" else 0
        self.arrays["input"][lane], self.x[lane] = settings, start
        self.runs[lane].t = self.runs[lane].h = 0.0
        self._lists[lane].count, self._told[lane] = 0, []
        head, events = self._head_at(lane), ctypes.byref(self._lists[lane])
        scratch = map(ctypes.c_void_p, self._own_scratch().addresses)
        self.codes[lane] = code = self.library.cdll.mg_begin(*head, events, *scratch)
        raise_failure(self._settings_of[lane])
        if code in REFUSED:
            raise self._refusal(lane, int(code))

    def doubts(self, lane: int) -> int:
        """What the figures of a lane speak against: bits of mg_doubts."""
        code = ctypes.c_int(int(self.codes[lane]))
        return int(self.library.cdll.mg_doubts(*self._head_at(lane), code))

    def sense(self, threads: int = 1) -> Array:
        """What the sensors of all lanes show, (n, n_sensor)."""
        self._share("mg_sense_many", (self._sensed_at,), threads, False)
        return self.sensed

    def sample(self, lane: int, record: Any) -> None:
        """Let an mg_record take the samples that are due at the present time of a lane."""
        events, scratch = ctypes.byref(self._lists[lane]), map(ctypes.c_void_p, self._own_scratch().addresses)
        now, no_steps = self.like.tables.real(self.runs[lane].t), ctypes.c_long(0)
        rest = ctypes.byref(record), events, *scratch
        self._short_calls.mg_advance(*self._head_at(lane), now, no_steps, *rest)
        raise_failure(self._settings_of[lane])

    def drain_events(self, lane: int) -> list[Event]:
        """The events of a lane since the last call."""
        listed = self._lists[lane]
        told = self._told[lane] + self.like.named([column[lane] for column in self._columns], listed.count)
        self._told[lane], listed.count = [], 0
        return told

    def save_all(self) -> bytes:
        """The states and outcomes of all lanes."""
        return checkpoint.joined(self.codes.tolist(), [self.save(lane) for lane in range(self.n)])

    def load_all(self, mark: bytes) -> None:
        """Put all lanes into saved states. Their events are dropped. Raises SimulationError, with the lanes
        as they were, where `mark` is not what `save_all` returned for as many lanes with the same numbers."""
        codes, states = checkpoint.parted(mark, self.n)
        before = [self.save(lane) for lane in range(self.n)]
        for lane, state in enumerate(states):
            try:
                checkpoint.load(self.library.cdll, self._head_at(lane), state)
            except SimulationError as refused:
                for done in range(lane):
                    checkpoint.load(self.library.cdll, self._head_at(done), before[done])
                where = f"load: run {lane}"
                raise SimulationError(where, refused.found, refused.allowed, refused.remedy) from None
        self.codes[:] = codes
        for lane in range(self.n):
            self._lists[lane].count, self._told[lane] = 0, []

    def save(self, lane: int) -> bytes:
        """The state of a lane, as `Session.save` gives it."""
        return checkpoint.save(self.library.cdll, self._head_at(lane), self.like.shared.checkpoint_size)

    def load(self, lane: int, state: bytes) -> None:
        """Put a lane into a saved state of a lane or session with the same numbers, from which it goes on.
        Its events are dropped. Raises SimulationError as `Session.load` does."""
        checkpoint.load(self.library.cdll, self._head_at(lane), state)
        self.codes[lane] = self._lists[lane].count = 0
        self._told[lane] = []

    def refusals(self, label: str = LANE) -> dict[int, SimulationError]:
        """The errors of the lanes that could not start, by lane, which they tell by `label`."""
        codes = enumerate(self.codes.tolist())
        return {lane: self._refusal(lane, code, label) for lane, code in codes if code in REFUSED}

    def _check_count(self, name: str, entries: Sequence[Any]) -> None:
        if len(entries) != self.n:
            raise SimulationError(name, f"{len(entries)} entries", f"{self.n}, one for each run", "")

    def _event_lists(self) -> tuple[list[Array], Any]:
        """The columns of the lists of events, (n, capacity) each, and the n mg_events."""
        capacity, real = self.like.shared.n_event, self.like.tables.dtype
        lists = (self.like.tables.Events * self.n)()
        field_of(lists, "capacity", INTEGER)[:] = capacity
        kinds = {"t": real, "speed": real, "after_t": real}
        arrays = rows_of_lanes(lists, {name: (capacity, kinds.get(name, INTEGER)) for name in EVENT_ARRAYS})
        return list(arrays.values()), lists

    def _share(self, name: str, by_lane: tuple[int, ...], threads: int, is_long: bool) -> None:
        """Call a function of the core once in each thread, which share the lanes; its arguments `by_lane` are
        addresses of arrays with an entry for each. `is_long`: Ctrl-C is to be heard meanwhile."""
        count = min(check_whole("threads", threads, "give the number of threads"), self.n)
        while len(self._scratch) < count:
            self._scratch.append(_Scratch(self.like))
        taken = ctypes.c_int(0)
        run = self.library.cdll[name]  # a function object of its own, as others may call it otherwise
        run.argtypes = [ctypes.c_int, *[ctypes.c_void_p] * (6 + len(by_lane))]
        head = ctypes.addressof(taken), self._systems_at, self._settings_at, self._runs_at

        def work(scratch: _Scratch) -> None:
            run(self.n, *head, *by_lane, *scratch.addresses)

        def share() -> None:
            others = [self._threads(count - 1).submit(work, scratch) for scratch in self._scratch[1:count]]
            work(self._scratch[0])
            for other in others:
                other.result()

        try:
            interruptible(share, self.arrays["stop"]) if is_long else share()
        finally:
            self.arrays["stop"][:] = 0
        for settings in self._settings_of:
            raise_failure(settings)

    def _own_scratch(self) -> _Scratch:
        """The scratch memory of the thread that asks for a lane alone."""
        if not self._scratch:
            self._scratch.append(_Scratch(self.like))
        return self._scratch[0]

    def _threads(self, count: int) -> ThreadPoolExecutor:
        if self._pool is None or self._pool_size < count:
            self._pool, self._pool_size = ThreadPoolExecutor(count), count
        return self._pool

    def _refusal(self, lane: int, code: int, label: str = LANE) -> SimulationError:
        session = Session(self.library, self.accuracies[lane], self._system_of[lane])
        session.x[:], session.feature_pair[:] = self.x[lane], self.arrays["feature_pair"][lane]
        session.input[:] = self.arrays["input"][lane]
        return refusal(session, code, self.runs[lane], label.format(lane=lane))

    def _head_at(self, lane: int) -> tuple[Any, ...]:
        """mg_system, mg_settings and mg_run of a lane."""
        settings, run = ctypes.byref(self._settings_of[lane]), ctypes.byref(self.runs[lane])
        return ctypes.byref(self._system_of[lane]), settings, run


def group_of(library: Library, libraries: Sequence[Library], accuracies: Sequence[Accuracy]) -> SessionGroup:
    """The lanes of a library with other numbers, one of `libraries` each (`library_with`), which the caller
    keeps: each with the numbers, start and inputs of its own, and with its record."""
    tables = each_once(library_tables, libraries)
    systems = [each.system for each in tables]
    group = SessionGroup(library, n=len(libraries), systems=systems, accuracies=accuracies)
    group.x[:] = [each.start for each in tables]
    group.arrays["input"][:, :-1:SETTING_SIZE] = [
        [kind["default"] for kind in each.manifest.instance["inputs"]] for each in libraries
    ]
    return group
