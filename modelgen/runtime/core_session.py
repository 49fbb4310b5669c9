"""One run of the C core: its tables, state and scratch, and the calls that move it."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.notation import ETA_SIZE, SETTING_SIZE
from modelgen.runtime import checkpoint
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.solver_choice import raise_failure, with_solver
from modelgen.runtime.tables.array_block import by_address
from modelgen.runtime.tables.ctypes_structures import (
    EVENT_ARRAYS,
    INTEGER,
    RUN_ARRAYS,
    Array,
    address,
    settings_of,
)
from modelgen.runtime.tables.library_tables import EVENT_PREFIX, library_tables
from modelgen.runtime.tables.planar_contacts import SUPPORT_POINTS
from modelgen.runtime.tables.scratch_memory import scratch
from modelgen.runtime.trajectory import EVENT_KINDS, LOAD_SWITCH, Event

CONTINUE, FULL = 1, 2
MANY = 64  # contacts or feature pairs, from which on a call of the core may take long
OF_RUN = itemgetter(*RUN_ARRAYS)
OF_EVENTS = itemgetter(*(EVENT_PREFIX + name for name in EVENT_ARRAYS))


class Session:
    """The state of a run in the core's memory. Arrays are views: they change as the run advances."""

    def __init__(self, library: Library, accuracy: Accuracy, system: Any = None) -> None:
        """`system`: an mg_system of the sizes of the library's, whose arrays the caller keeps; None: that of
        the library."""
        shared = library_tables(library)
        self.shared = shared
        self.library = library
        self.accuracy = accuracy
        self.redundant_joints: list[str] = []
        self.instance: Mapping[str, Any] = library.manifest.instance
        self.tables = shared.tables
        self.system = shared.system if system is None else system
        self.feature_pair_names = shared.feature_pair_names  # limits have no features
        self.contacts, self.joints = shared.contact_names, shared.joint_names
        self.n_shown, self.n_patch_slot = len(self.contacts), shared.n_patch_slot
        self.n_body, self.n_contact = len(self.instance["bodies"]), shared.n_contact
        self.n_x = len(shared.start)
        settings = settings_of(shared.tables, accuracy, self.instance)
        self.settings = with_solver(settings, accuracy, library)
        reals, real_at = shared.reals.zeros(self.tables.dtype)
        integers, integer_at = shared.integers.zeros(INTEGER)
        self._arrays, self._addresses = reals | integers, real_at | integer_at
        self.x, self.force, self.margin = reals["x"], reals["force"], reals["margin"]
        self.tilt_direction, self.rolling_start = reals["tilt_direction"], integers["rolling_start"]
        self.closed, self.active = integers["closed"], integers["active"]
        self.friction_mode, self.feature_pair = integers["friction_mode"], integers["feature_pair"]
        self.stop = integers["stop"]
        self.input, self.applied_input = reals["input"], reals["applied_input"]
        self.x[:], self.feature_pair[:] = shared.start, -1
        self.input[:-1:SETTING_SIZE] = [each["default"] for each in self.instance["inputs"]]
        self.run = self.tables.Run(0.0, 0.0, *OF_RUN(self._addresses))
        self.events = self.tables.Events(shared.n_event, 0, *OF_EVENTS(self._addresses))
        self.sensed = self._reals(shared.n_sensor + 1)
        self.work, self.iwork = scratch(shared.work_size, shared.iwork_size, self.tables.dtype)
        self._head = (ctypes.byref(self.system), ctypes.byref(self.settings), ctypes.byref(self.run))
        self._scratch = (ctypes.c_void_p(address(self.work)), ctypes.c_void_p(address(self.iwork)))

    @property
    def may_take_long(self) -> bool:
        """Whether one step or one search may, so that Ctrl-C is to be heard within a call."""
        of_searches = self.system.n_cell_tree or self.system.n_feature_pair >= MANY
        return self.n_contact >= MANY or bool(of_searches)

    @property
    def run_arrays(self) -> dict[str, Array]:
        """The arrays of the mg_run, by name."""
        return {name: self._arrays[name] for name in RUN_ARRAYS}

    @property
    def eta(self) -> Array:
        """The contact parameters of all contacts, (n_eta,)."""
        return self.x[self.n_x - 1 - self.shared.slots.n_eta : self.n_x - 1]

    def _reals(self, n: int) -> Array:
        return np.zeros(n, dtype=self.tables.dtype)

    def arrays(self) -> dict[int, Array]:
        """All arrays that the structures of a session of the library's own system point to, by address."""
        shared = {address(array): array for array in self.shared.arrays}
        return shared | by_address(self._arrays, self._addresses)

    def poses(self) -> Array:
        """The poses of all bodies at the state, (nb, 12): p, then R column-major."""
        out = self._reals(12 * max(self.n_body, 1))
        self.library.cdll.mg_pose_all(*self._head, ctypes.c_void_p(address(out)), *self._scratch)
        return out.reshape(-1, 12).astype(float)

    def drain_events(self) -> list[Event]:
        """The events since the last call, removed from the core's list."""
        told = self.named(OF_EVENTS(self._arrays), self.events.count)
        self.events.count = 0
        return told

    def named(self, columns: Sequence[Array], count: int) -> list[Event]:
        """The first events of an mg_events, given by its columns."""
        if not count:
            return []
        given = [column[:count].tolist() for column in columns]
        return [
            Event(
                float(t),
                EVENT_KINDS[kind],
                *self._subject(kind, contact, told, feature_pair),
                speed=float(speed),
                after_t=float(after_t) if after_t >= 0 else None,
            )
            for t, kind, contact, told, feature_pair, speed, after_t in zip(*given, strict=True)
        ]

    def _subject(self, kind: int, number: int, told: int, feature_pair: int) -> tuple[str, str]:
        """What an event is of: a contact and its features, or a load."""
        if EVENT_KINDS[kind] == LOAD_SWITCH:
            return self.switching_loads[number], ""
        return self._named(number, told, feature_pair)

    def _named(self, contact: int, told: int, feature_pair: int) -> tuple[str, str]:
        """The contact and its features; of a support point, its patch and the two faces. `told`: the number
        by which the core tells it (mg_told_contact)."""
        slots = self.shared.slots
        if contact < self.n_shown:
            own = slots.feature_pair.order[feature_pair]
            return self.contacts[told], self.feature_pair_names[own] if feature_pair >= 0 else ""
        if not self.instance["patches"]:
            return "", ""
        patch = slots.patch.order[(feature_pair - len(slots.feature_pair)) // SUPPORT_POINTS]
        pair, _, faces = str(self.instance["patches"][patch]["name"]).rpartition(":")
        return self.contacts[told] if told != contact else pair, faces

    @property
    def switching_loads(self) -> list[str]:
        """Of each switching function the kind of its load, and its bodies."""
        kinds, bodies = self.library.manifest.kinds["load"], self.instance["bodies"]
        found: list[str] = []
        for load in self.instance["loads"]:
            kind, names = kinds[load["kind"]], (bodies[body]["name"] for body in load["bodies"])
            found += [f"{kind['kind']} on {' and '.join(names)}"] * int(kind.get("switches", 0))
        return found

    @property
    def contact_labels(self) -> list[str]:
        """The names of contacts; of those in slots, whose pairs are others at each time, their numbers."""
        slots = self.shared.slots
        first, end = slots.contact.at, slots.contact.at + len(slots.contacts_of_slots)
        return [f"slot {k - first}" if first <= k < end else self.contacts[k] for k in range(self.n_shown)]

    def contact_name(self, contact: int) -> str:
        """The name of a contact; of a support point, that of its pair."""
        told = int(self.library.cdll.mg_told_contact(self._head[0], self._head[2], ctypes.c_int(contact)))
        if contact < self.n_shown:
            return self.contacts[told]
        slot = (contact - self.n_shown) // SUPPORT_POINTS
        return (
            self._named(contact, told, int(self.feature_pair[contact]))[0] if slot < self.n_patch_slot else ""
        )

    def begin(self) -> int:
        """Settles the start; returns the core's outcome code (see `runtime.start.begin`)."""
        self.start_code = int(
            self.library.cdll.mg_begin(*self._head, ctypes.byref(self.events), *self._scratch)
        )
        raise_failure(self.settings)
        return self.start_code

    def sense(self) -> None:
        """Writes what the sensors show at the state into `sensed`."""
        self.library.cdll.mg_sense(*self._head, ctypes.c_void_p(address(self.sensed)), *self._scratch)

    def save(self) -> bytes:
        """The whole state of the run. A session of the same library and settings into which it is loaded goes
        on bit for bit as this one would. Events that were not drained are not part of it."""
        return checkpoint.save(self.library.cdll, self._head, self.shared.checkpoint_size)

    def load(self, state: bytes) -> None:
        """Go to a saved state; the session need not have begun. Its undrained events are dropped.

        Raises SimulationError where the bytes are not what `save` returned for the same library and
        settings; it says what differs. The run then is as it was.
        """
        checkpoint.load(self.library.cdll, self._head, state)
        self.events.count = self.start_code = 0

    def ranks(self) -> list[int]:
        """How many rows of each joint are independent of those of the joints before it."""
        rank = np.zeros(len(self.joints) + 1, dtype=np.intc)
        self.library.cdll.mg_joint_ranks(*self._head, ctypes.c_void_p(address(rank)), *self._scratch)
        return [int(n) for n in rank[:-1]]

    def unbounded(self) -> int:
        """Index of the function of time that made the run non-finite, or -1: loads, then bodies, then
        joints."""
        return int(self.library.cdll.mg_unbounded(*self._head, *self._scratch))

    def settle(self, contact: int, eta: Array | None = None) -> dict[str, Any]:
        """Newton from `eta` (None: the state's) for one contact: steps (-1: failed), d, margin and so on."""
        start = self.shared.slots.eta_of(contact)
        size = sum(ETA_SIZE[kind] for kind in self.layout(contact))
        local = np.array(self.eta[start : start + size] if eta is None else eta, dtype=self.tables.dtype)
        out = {"d": 1, "residual": 2, "margin": 2, "normal": 3, "point_o": 3, "point_f": 3}
        arrays = {name: self._reals(length) for name, length in out.items()}
        pointers = [ctypes.c_void_p(address(a)) for a in (local, *arrays.values())]
        steps = self.library.cdll.mg_settle(*self._head, ctypes.c_int(contact), *pointers, *self._scratch)
        arrays["d"] = arrays["d"][0]
        return {"steps": steps, "eta": local, **arrays}

    def find_minima(self, queries: Any) -> None:
        """Answers an mg_minima_queries; for a session that has not begun."""
        self.library.cdll.mg_find_minima(*self._head, ctypes.byref(queries), *self._scratch)

    def features_of(self, contact: int) -> Mapping[str, Any] | None:
        """The entry of the feature pair that a contact with shapes is on, in a slot that of the pattern, with
        the bodies of its pair; None on no feature pair."""
        slots, held = self.shared.slots, int(self.feature_pair[contact])
        if held < 0 or slots.entry_of(contact) is None:
            return None
        o, f = slots.bodies_of(contact, held, self._arrays["slot_balls"])
        return {**self.instance["feature_pairs"][int(slots.feature_pair.order[held])], "o": o, "f": f}

    def layout(self, contact: int) -> list[str]:
        """The parametrisation of each side of a contact (keys of ETA_SIZE); empty on no feature pair."""
        feature_pair = self.features_of(contact)
        if feature_pair is None:
            return []
        kind = feature_pair["kind"]
        return list(self.library.manifest.kinds["contact"][kind]["eta"])

    def advance(self, t_stop: float, max_steps: int, record: Any) -> int:
        """Runs to t_stop or for max_steps accepted steps; returns the core's code."""
        head, tail = self.advance_arguments(max_steps, record)
        code = int(self.library.cdll.mg_advance(*head, self.tables.real(t_stop), *tail))
        raise_failure(self.settings)
        return code

    def advance_arguments(self, max_steps: int, record: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """The arguments of mg_advance before and after t_stop, made once for many calls."""
        rest = ctypes.byref(record), ctypes.byref(self.events)
        return self._head, (ctypes.c_long(max_steps), *rest, *self._scratch)

    def smooth(self, n: int) -> None:
        """Takes n RK4 steps without events, projection or energy ledger."""
        self.library.cdll.mg_smooth(*self._head, ctypes.c_long(n), *self._scratch)

    def doubts(self, run: Any, code: int) -> int:
        """What the figures of an mg_run that has come to an outcome of the core speak against: bits of
        mg_doubts."""
        return int(self.library.cdll.mg_doubts(*self._head[:2], ctypes.byref(run), ctypes.c_int(code)))

    def energy_drift(self, run: Any) -> float:
        """max |E - E_0 - work - corrections| of an mg_run, relative to its largest kinetic energy, or to
        m L^2 / T^2 at rest."""
        return float(run.report.energy_error_max) / self._moved_energy(run)

    def correction_energy(self, run: Any) -> float:
        """The sum of the amounts by which corrections of positions changed the energy, relative as
        `energy_drift`."""
        return float(run.report.correction_energy) / self._moved_energy(run)

    def energy_rounding(self, run: Any) -> float:
        """What rounding of energy and work in each step may add up to, relative as `energy_drift`."""
        return self._energy("mg_energy_rounding", run) / self._moved_energy(run)

    def _moved_energy(self, run: Any) -> float:
        """The largest kinetic energy of an mg_run, or m L^2 / T^2 at rest, J."""
        return self._energy("mg_moved_energy", run)

    def _energy(self, function: str, run: Any) -> float:
        """What a function of the core returns of an mg_run, J."""
        found = getattr(self.library.cdll, function)
        found.restype = self.tables.real
        result = found(self._head[0], ctypes.byref(run))
        return float(getattr(result, "value", result))

    def batch(self, runs: ctypes.Array[ctypes.Structure], t_stop: float, codes: Array) -> None:
        """Starts and advances each mg_run of an array to t_stop; writes the core's codes."""
        ends = self.tables.real(t_stop), ctypes.c_void_p(address(codes)), ctypes.byref(self.events)
        self.library.cdll.mg_batch(*self._head[:2], len(runs), runs, *ends, *self._scratch)
        raise_failure(self.settings)

    def evaluate(self, t: float, x: Array, x_dot: Array) -> None:
        """Writes the right-hand side at (t, x) into x_dot, and the forces of active contacts into `force`."""
        pointers = ctypes.c_void_p(address(x)), ctypes.c_void_p(address(x_dot))
        self.library.cdll.mg_evaluate(*self._head, self.tables.real(t), *pointers, *self._scratch)
