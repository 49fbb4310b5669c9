"""Contact parameters of formulas where poses or lengths are given: those of the closest points, by search."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from modelgen.codegen.build import build
from modelgen.codegen.emit import emit
from modelgen.codegen.library import Library
from modelgen.derivation import Derivation, Formula
from modelgen.errors import ModelgenError
from modelgen.file_writing import scratch_folder
from modelgen.report.kind_scenes import pair_scene
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.closest_points import ClosestPoints, closest_points
from modelgen.runtime.core_session import Session
from modelgen.runtime.poses import pose_matrices
from modelgen.scene.scene_types import Scene
from modelgen.verification.formula_inputs import Numbers
from modelgen.verification.verify import OF_CONTACTS, OF_SEARCH, is_of_limit

PLACED_BY = {"pose_o", "pose_f", "parameters"}  # inputs of a contact that move its closest points


@dataclass(frozen=True)
class ClosestInputs:
    """The searches of one `inspect`. `kind`: the pair of shapes that is inspected; empty: a scene."""

    derivation: Derivation
    derive: Callable[[Scene], Derivation]
    kind: str = ""

    def completed(self, formula: Formula, inputs: Numbers, own: Mapping[str, Any]) -> Numbers:
        """`inputs`, with eta or the normal at the closest points where `own` gives poses and not those.

        Raises ModelgenError where the shapes have no closest points there.
        """
        model = self.derivation.model
        if formula.role == "rhs":
            is_given = "q" not in own or "eta" in own or not model.n_eta
            return inputs if is_given else {**inputs, "eta": self._of_state(inputs)}
        if formula.role not in (*OF_CONTACTS, *OF_SEARCH) or is_of_limit(formula, model):
            return inputs
        wanted = [name for name in ("eta", "normal") if inputs.get(name) and name not in own]
        if not wanted or not PLACED_BY & own.keys():
            return inputs
        found = self._of_contact(formula.kind, inputs, own)
        return {**inputs, **{name: getattr(found, name)[0].tolist() for name in wanted}}

    def _of_contact(self, kind: int, inputs: Numbers, own: Mapping[str, Any]) -> ClosestPoints:
        """Closest points of the first feature pair of a kind, with the poses and lengths of `inputs`."""
        entries = self.library.manifest.instance["feature_pairs"]
        which = next(k for k, entry in enumerate(entries) if entry["kind"] == kind)
        poses = [_whole(inputs.get(f"pose_{side}", ())) for side in "of"]
        is_changed = "parameters" in own
        library = self._with_lengths(inputs["parameters"]) if self.kind and is_changed else self.library
        parameters = np.array(inputs["parameters"]) if is_changed and not self.kind else None
        return _searched(library, which, poses, parameters)

    def _with_lengths(self, parameters: Sequence[float]) -> Library:
        """The library of the pair of shapes that is inspected, with other lengths."""
        entry = self.library.manifest.instance["feature_pairs"][0]  # coaxial supports come after it
        names = self.library.manifest.kinds["contact"][entry["kind"]]["parameters"]
        lengths: dict[str, dict[str, float]] = {"o": {}, "f": {}}
        for name, value in zip(names, parameters, strict=True):
            side, _, length = name.partition(".")
            lengths[self.derivation.model.bodies[entry[side]].name][length] = value
        return _built(self.derive(pair_scene(self.kind, lengths)))

    def _of_state(self, inputs: Numbers) -> list[float]:
        """eta of all contacts at coordinates q."""
        model, session = self.derivation.model, Session(self.library, Accuracy())
        session.x[: model.n_q], session.run.t = inputs["q"], inputs["t"][0]
        poses, eta = session.poses(), np.array(inputs["eta"])
        for pair in model.pairs:
            which = pair.feature_pairs[0]
            entry = model.feature_pairs[which]
            found = _searched(self.library, which, [poses[entry.o], poses[entry.f]], None)
            start = model.contacts[pair.contacts[0]].eta
            eta[start : start + found.eta.shape[1]] = found.eta[0]
        return [float(value) for value in eta]

    @cached_property
    def library(self) -> Library:
        """The library of what is inspected."""
        return _built(self.derivation)


def _built(derivation: Derivation) -> Library:
    with scratch_folder() as folder:
        return build(emit(derivation), folder=folder)


def _whole(pose: Sequence[float]) -> np.ndarray[Any, Any]:
    """A pose of 12 numbers; what the formula does not take is that of the world."""
    return np.array([*pose, *np.append(np.zeros(3), np.eye(3).ravel())[len(pose) :]])


def _searched(
    library: Library, which: int, poses: Sequence[Any], parameters: np.ndarray[Any, Any] | None
) -> ClosestPoints:
    """Closest points of a feature pair, from its o to its f."""
    entry = library.manifest.instance["feature_pairs"][which]
    first, second = reversed(poses) if entry["swapped"] else poses
    found = closest_points(library, which, pose_matrices(first), pose_matrices(second), parameters=parameters)
    if not np.isfinite(found.d[0]):
        where = "no closest points of the shapes at these poses"
        raise ModelgenError("--at: eta", where, "poses at which they exist", "move the bodies, or give eta")
    return replace(found, normal=-found.normal) if entry["swapped"] else found
