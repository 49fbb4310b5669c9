"""The samples of a run, from the core's arrays to columns in world axes."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from modelgen.rotations import quaternions_of
from modelgen.runtime.core_session import Session
from modelgen.runtime.joint_results import joint_columns
from modelgen.runtime.tables.array_block import ArrayBlock, by_address
from modelgen.runtime.tables.ctypes_structures import INTEGER, RECORD_ARRAYS, Array

INTEGERS = ("feature_pair", "patch")  # columns of integers


class Recording:
    """Room for one sample at each of `times`, filled by the core."""

    def __init__(self, session: Session, times: Array) -> None:
        n_joint, shared = len(session.joints), session.shared
        sizes = (session.n_body, session.n_contact, n_joint, session.instance["n_eta"])
        reals_of_n, integers_of_n = _layout(
            len(times), *sizes, session.n_patch_slot, len(shared.shares), shared.n_sensor
        )
        integers, integer_at = integers_of_n.zeros(INTEGER)
        reals, real_at = reals_of_n.zeros(session.tables.dtype)
        self.arrays, self._addresses = integers | reals, integer_at | real_at
        self.arrays["t"][:] = times
        self.session = session
        self.record = session.tables.Record(len(times), 0, *(self._addresses[name] for name in RECORD_ARRAYS))

    @property
    def placed(self) -> dict[int, Array]:
        """The columns by address."""
        return by_address(self.arrays, self._addresses)

    def end(self) -> None:
        """Adds a sample at the end of the run if it ended after the last one with a finite state."""
        count, t = self.record.count, self.arrays["t"]
        if 0 < count < len(t) and self.session.run.t > t[count - 1] and np.isfinite(self.session.x).all():
            t[count] = self.session.run.t
            self.record.capacity = count + 1
            self.session.advance(float(t[count]), 0, self.record)

    def columns(self, count: int | None = None, runs: int = 1) -> dict[str, Any]:
        """The first samples, those taken so far unless given, as the fields of a Trajectory; of several runs
        one run after the other, as many of each."""
        kept = {
            name: array[: self.record.count if count is None else count]
            for name, array in self.arrays.items()
        }
        rotation = np.swapaxes(kept["pose"][..., 3:].reshape(*kept["pose"].shape[:2], 3, 3), -1, -2)
        turning = {
            "quaternion": quaternions_of(rotation),
            "w": np.einsum("nbij,nbj->nbi", rotation, kept["twist"][..., 3:]),
        }
        unknown = self._unknown_turning()
        for column in turning.values() if unknown else ():
            column[:, unknown] = np.nan
        return {
            "t": kept["t"],
            "p": kept["pose"][..., :3],
            "v": kept["twist"][..., :3],
            **turning,
            **{name: kept[name] for name in ("eta", "energy", "work", "patch", "sensors")},
            **{name: kept[name][:, : self.session.n_shown] for name in ("force", "gap", "feature_pair")},
            "patch_force": kept["pressure"][..., 0],
            "patch_point": kept["pressure"][..., 1:],
            "patch_friction": kept["patch_friction"][..., :3],
            "patch_torque": kept["patch_friction"][..., 3],
            "patch_slip": kept["patch_friction"][..., 4:7],
            "patch_share": kept["patch_share"],
            "patch_spin": kept["patch_friction"][..., 7],
            **joint_columns(self.session, kept, rotation, runs),
            "points_o": kept["point_o"][:, : self.session.n_shown],
            "points_f": kept["point_f"][:, : self.session.n_shown],
            "normals": kept["normal"][:, : self.session.n_shown],
            "friction": kept["friction"][:, : self.session.n_shown],
            "contact_torque": kept["torque"][:, : self.session.n_shown],
            "slip": kept["slip"][:, : self.session.n_shown],
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
) -> tuple[ArrayBlock, ArrayBlock]:
    """Where the columns of n samples lie: those of real numbers, and those of integers."""
    reals: dict[str, tuple[int, ...]] = {
        **{"t": (n,), "pose": (n, n_body, 12), "twist": (n, n_body, 6), "eta": (n, n_eta)},
        **{"force": (n, n_contact), "gap": (n, n_contact), "energy": (n,), "work": (n,)},
        **dict.fromkeys(("normal", "point_o", "point_f", "friction", "torque", "slip"), (n, n_contact, 3)),
        **{"pressure": (n, n_patch_slot, 4), "patch_friction": (n, n_patch_slot, 8)},
        "patch_share": (n, n_share),
        **{"joint_wrench": (n, n_joint, 6), "coordinate": (n, n_joint, 3), "sensors": (n, n_sensor)},
    }
    integers = zip(INTEGERS, ((n, n_contact), (n, n_patch_slot)), strict=True)
    return ArrayBlock(reals), ArrayBlock(dict(integers))
