"""The contacts of a run at one instant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.runtime.by_name import ByName
from modelgen.runtime.core_session import Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.tables.ctypes_structures import Array


@dataclass(frozen=True, slots=True)
class Contact:
    """A contact at an instant, in SI units and world axes; NaN where it follows no closest points."""

    gap: float  # m
    force: float  # N, normal
    friction: Array  # (3,) N, on the second body of the contact's kind
    normal: Array  # (3,) from the first to the second body
    points: tuple[Array, Array]  # (3,) m, on both bodies
    features: str  # that the contact is between, where its shapes have several


def columns_now(session: Session) -> dict[str, Any]:
    """The session's state as one sample, named as the fields of a Trajectory."""
    recording = Recording(session, np.array([float(session.run.t)]))
    session.advance(float(session.run.t), 0, recording.record)
    return recording.columns()


def contacts_of(session: Session) -> Mapping[str, Contact]:
    """The contacts with shapes, then the limits of joints, by name, at the session's state."""
    shown = columns_now(session)
    names = (*session.feature_pair_names, "")
    found = {
        name: Contact(
            float(shown["gap"][0, k]),
            float(shown["force"][0, k]),
            shown["friction"][0, k].copy(),
            shown["normals"][0, k].copy(),
            (shown["points_o"][0, k].copy(), shown["points_f"][0, k].copy()),
            names[int(shown["feature_pair"][0, k])],
        )
        for k, name in enumerate(shown["contact_names"])
    }
    return ByName(found, "contact")
