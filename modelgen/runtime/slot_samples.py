"""Samples of a run whose near pairs are in slots: columns of contacts with pairs that do not change, and of
all pairs that were near at a sample, by the numbers that the core tells.

The core fills a few rows at a time, with a place for each slot; what is in them is taken out here.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from typing import Any

import numpy as np

from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.ctypes_structures import Array

BYTES = 2**25  # of the rows that the core fills at a time
OF_CONTACTS = ("force", "gap", "feature_pair", "normal", "point_o", "point_f", "friction", "torque", "slip")
OF_PATCHES = ("patch", "pressure", "patch_friction")


class SlotSamples:
    """What is kept of the rows that the core has filled."""

    def __init__(self, session: Session, arrays: Mapping[str, Array], n: int) -> None:
        """`arrays`: the columns of the core, a few rows; `n`: samples of the whole run."""
        slots = session.shared.slots
        self._session, self._slots, self._arrays, self.taken = session, slots, arrays, 0
        self._own = slots.own_contacts
        self._own_patches = np.arange(slots.patch_slot.at)
        eta = np.arange(slots.n_eta)
        of_limits = int(session.instance["n_eta"]) - slots.eta_of_contacts
        self._own_eta = np.concatenate([eta[: slots.eta_of_contacts], eta[slots.n_eta - of_limits :]])
        picks = dict.fromkeys(OF_CONTACTS, self._own) | dict.fromkeys(OF_PATCHES, self._own_patches)
        self._picks: dict[str, Array] = picks | {"eta": self._own_eta}
        self.kept = {
            name: np.zeros((n, *self._picked(name, column).shape[1:]), dtype=column.dtype)
            for name, column in arrays.items()
            if name not in ("t", "slot_balls")
        }
        self._contacts: list[tuple[Array, dict[str, Array]]] = []  # of each row: numbers told, values
        self._patches: list[tuple[Array, Array, dict[str, Array]]] = []  # pairs told, patches, values

    def _picked(self, name: str, column: Array) -> Array:
        return column[:, self._picks[name]] if name in self._picks else column

    def take(self, count: int) -> None:
        """Take the first rows."""
        for name, kept in self.kept.items():
            kept[self.taken : self.taken + count] = self._picked(name, self._arrays[name][:count])
        for row in range(count):
            self._take_row(row)
        self.taken += count

    def _take_row(self, row: int) -> None:
        told = self._slots.pairs_told(self._arrays["slot_balls"][row])
        contacts = self._slots.contacts_of_slots
        held = contacts[self._arrays["feature_pair"][row, contacts] >= 0]
        numbers = self._slots.contacts_told(held, told)
        self._contacts.append((numbers, self._row(OF_CONTACTS, row, held)))
        of_slots = np.arange(self._slots.patch_slot.at, len(self._slots.patch_slot))
        resting = of_slots[self._arrays["patch"][row, of_slots] >= 0]
        patches = self._arrays["patch"][row, resting]
        pairs = self._slots.pairs_of_patches(patches, told)
        self._patches.append((pairs, self._slots.patch.order[patches], self._row(OF_PATCHES, row, resting)))

    def _row(self, names: tuple[str, ...], row: int, places: Array) -> dict[str, Array]:
        return {name: self._arrays[name][row, places] for name in names}

    def columns(self) -> dict[str, Any]:
        """The columns of all samples, with the names of their contacts and patches."""
        seen = sorted(set(chain.from_iterable(numbers.tolist() for numbers, _ in self._contacts)))
        columns = self._widened(OF_CONTACTS, seen, ((list(each), of) for each, of in self._contacts))
        columns["feature_pair"] = self._slots.feature_pairs_of_patterns(columns["feature_pair"])
        rows = [([*zip(a.tolist(), b.tolist(), strict=True)], of) for a, b, of in self._patches]
        resting = sorted(set(chain.from_iterable(keys for keys, _ in rows)))
        columns |= self._widened(OF_PATCHES, resting, rows)
        first, own = len(self._session.shared.patch_names), len(self._own_patches)
        columns["patch"][:, own:] = np.where(
            columns["patch"][:, own:] >= 0, first + np.arange(len(resting)), -1
        )
        names = self._session.contacts
        told = [names[int(k)] for k in (*self._own, *seen)]
        patches = self._session.shared.patch_names
        return (
            self.kept
            | columns
            | {
                "contact_names": tuple(told),
                "patch_names": (*patches, *(self._slots.patch_name(pair, patches[k]) for pair, k in resting)),
            }
        )

    def _widened(self, names: tuple[str, ...], seen: list[Any], rows: Any) -> dict[str, Any]:
        """Columns with those of `seen` after the ones kept, empty where a row has none of them."""
        place = {key: k for k, key in enumerate(seen)}
        made = {name: self._empty(name, len(seen)) for name in names}
        for row, (keys, values) in enumerate(rows):
            at = [place[key] for key in keys]
            for name, column in made.items():
                column[row, at] = values[name]
        return {name: np.concatenate([self.kept[name], column], axis=1) for name, column in made.items()}

    def _empty(self, name: str, width: int) -> Array:
        like = self.kept[name]
        shape = (len(like), width, *like.shape[2:])
        if name in ("feature_pair", "patch"):
            return np.full(shape, -1, dtype=like.dtype)
        is_nan = name in ("gap", "normal", "point_o", "point_f")
        made = np.full(shape, np.nan if is_nan else 0.0, dtype=like.dtype)
        if name == "pressure":
            made[..., 1:] = np.nan
        return made


def rows_at_a_time(width: int, n: int) -> int:
    """How many of n samples of `width` bytes the core fills at a time."""
    return max(min(n, BYTES // max(width, 1)), 1)
