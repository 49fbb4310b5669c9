"""The samples of a run, from the core's arrays to columns in world axes."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from typing import Any

import numpy as np

from modelgen.rotations import quaternions_of
from modelgen.runtime.core_session import Session
from modelgen.runtime.joint_results import joint_columns
from modelgen.runtime.tables.array_block import ArrayBlock, by_address
from modelgen.runtime.tables.ctypes_structures import INTEGER, RECORD_ARRAYS, Array, address

INTEGERS = ("feature_pair", "patch", "slot_balls")  # columns of integers
NAMES = ("contact_names", "patch_names")  # columns that are the names of others
_EMPTY = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


class Recording:
    """Room for one sample at each of `times`, filled by the core."""

    def __init__(self, session: Session, times: Array, at_once: bool = False) -> None:
        """`at_once`: there is a row for each sample, also where that takes much memory."""
        n_joint, shared = len(session.joints), session.shared
        sizes = (session.n_body, session.n_contact, n_joint, shared.slots.n_eta)
        more = session.n_patch_slot, len(shared.shares), shared.n_sensor, 2 * shared.slots.count
        self._n = rows = len(times)
        if shared.slots:
            from modelgen.runtime.slot_samples import SlotSamples, rows_at_a_time  # few scenes need it
        if shared.slots and not at_once:
            width = sum(block.size for block in _layout(1, *sizes, *more)) * session.tables.dtype.itemsize
            rows = rows_at_a_time(width, self._n)
        reals_of_n, integers_of_n = _layout(rows, *sizes, *more)
        integers, integer_at = integers_of_n.zeros(INTEGER)
        reals, real_at = reals_of_n.zeros(session.tables.dtype)
        t = np.array(times, dtype=session.tables.dtype)
        self.arrays = integers | reals | {"t": t}
        self._addresses = integer_at | real_at | {"t": address(t)}
        self.session = session
        self._rows = rows
        self.record = session.tables.Record(rows, 0, *(self._addresses[name] for name in RECORD_ARRAYS))
        self._samples = SlotSamples(session, self.arrays, self._n) if shared.slots else None
        if self._samples is not None and not at_once:
            self._empty = _EMPTY(lambda _: self._take())  # which lives as long as the record
            self.record.empty = ctypes.cast(self._empty, ctypes.c_void_p)

    def _take(self) -> None:
        """Empty the rows that the core has filled."""
        assert self._samples is not None
        self._samples.take(self.record.count)
        taken = self._samples.taken
        self.record.count, self.record.capacity = 0, min(self._rows, self._n - taken)
        self.record.t = self._addresses["t"] + taken * self.arrays["t"].itemsize

    @property
    def placed(self) -> dict[int, Array]:
        """The columns by address."""
        return by_address(self.arrays, self._addresses)

    @property
    def count(self) -> int:
        """Samples taken so far."""
        return int(self.record.count) + (self._samples.taken if self._samples else 0)

    def end(self) -> None:
        """Adds a sample at the end of the run if it ended after the last one with a finite state."""
        count, t = self.count, self.arrays["t"]
        if 0 < count < len(t) and self.session.run.t > t[count - 1] and np.isfinite(self.session.x).all():
            t[count] = self.session.run.t
            self.record.capacity = self.record.count + 1
            self.session.advance(float(t[count]), 0, self.record)

    def columns(self, count: int | None = None, runs: int = 1) -> dict[str, Any]:
        """The first samples, those taken so far unless given, as the fields of a Trajectory, with the names
        of contacts and patches; of several runs one run after the other, as many of each."""
        shared, names = self.session.shared, {}
        whole: dict[str, Any] = self.arrays
        if self._samples is None:
            names = {"contact_names": self.session.contacts, "patch_names": shared.patch_names}
        else:
            self._samples.take(int(self.record.count) if count is None else count - self._samples.taken)
            self.record.count = 0
            whole = {"t": self.arrays["t"], **self._samples.columns()}
            names = {name: whole.pop(name) for name in NAMES}
        kept = {name: array[: self.count if count is None else count] for name, array in whole.items()}
        shown = len(names["contact_names"])
        rotation = np.swapaxes(kept["pose"][..., 3:].reshape(*kept["pose"].shape[:2], 3, 3), -1, -2)
        turning = {
            "quaternion": quaternions_of(rotation),
            "w": np.einsum("nbij,nbj->nbi", rotation, kept["twist"][..., 3:]),
        }
        unknown = self._unknown_turning()
        for column in turning.values() if unknown else ():
            column[:, unknown] = np.nan
        return {
            **names,
            "t": kept["t"],
            "p": kept["pose"][..., :3],
            "v": kept["twist"][..., :3],
            **turning,
            **{name: kept[name] for name in ("eta", "energy", "work", "patch", "sensors")},
            **{name: kept[name][:, :shown] for name in ("force", "gap", "feature_pair")},
            "patch_force": kept["pressure"][..., 0],
            "patch_point": kept["pressure"][..., 1:],
            "patch_friction": kept["patch_friction"][..., :3],
            "patch_torque": kept["patch_friction"][..., 3],
            "patch_slip": kept["patch_friction"][..., 4:7],
            "patch_share": kept["patch_share"],
            "patch_spin": kept["patch_friction"][..., 7],
            **joint_columns(self.session, kept, rotation, runs),
            "points_o": kept["point_o"][:, :shown],
            "points_f": kept["point_f"][:, :shown],
            "normals": kept["normal"][:, :shown],
            "friction": kept["friction"][:, :shown],
            "contact_torque": kept["torque"][:, :shown],
            "slip": kept["slip"][:, :shown],
        }

    def _unknown_turning(self) -> list[int]:
        """Bodies whose rotation is left out because nothing observes it."""
        instance = self.session.instance
        if not instance["observe"]:
            return []
        return [k for k, b in enumerate(instance["bodies"]) if b["motion"] == "point"]


@lru_cache(maxsize=64)
def _layout(
    n: int,
    n_body: int,
    n_contact: int,
    n_joint: int,
    n_eta: int,
    n_patch_slot: int,
    n_share: int,
    n_sensor: int,
    n_slot_ball: int,
) -> tuple[ArrayBlock, ArrayBlock]:
    """Where the columns of n samples lie: those of real numbers, and those of integers."""
    reals: dict[str, tuple[int, ...]] = {
        **{"pose": (n, n_body, 12), "twist": (n, n_body, 6), "eta": (n, n_eta)},
        **{"force": (n, n_contact), "gap": (n, n_contact), "energy": (n,), "work": (n,)},
        **dict.fromkeys(("normal", "point_o", "point_f", "friction", "torque", "slip"), (n, n_contact, 3)),
        **{"pressure": (n, n_patch_slot, 4), "patch_friction": (n, n_patch_slot, 8)},
        "patch_share": (n, n_share),
        **{"joint_wrench": (n, n_joint, 6), "coordinate": (n, n_joint, 3), "sensors": (n, n_sensor)},
    }
    integers = zip(INTEGERS, ((n, n_contact), (n, n_patch_slot), (n, n_slot_ball)), strict=True)
    return ArrayBlock(reals), ArrayBlock(dict(integers))
