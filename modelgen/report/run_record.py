"""A run as it is kept and drawn: the columns of a Trajectory, who touches whom, and on which surfaces."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import expect
from modelgen.report.recorded_scene import kept_scene, read_again
from modelgen.report.resting_face_outlines import face_outlines
from modelgen.report.surface_grids import contact_meshes, feature_pair_of
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.by_name import ByName
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import Scene

Array = np.ndarray[Any, Any]
COLUMNS = (
    *("t", "p", "quaternion", "v", "w", "eta", "force", "gap"),
    *("friction", "contact_torque", "slip", "points_o", "points_f", "normals", "energy", "work"),
    *("joint_force", "joint_torque", "coordinates", "sensors"),
    *("patch", "patch_force", "patch_point", "patch_friction", "patch_torque", "patch_slip", "patch_spin"),
    "patch_share",
    *("position_error", "rotation_error", "velocity_error", "spin_error"),
)


@dataclass(frozen=True, slots=True, repr=False)
class Record:
    """Contents of a run file; `save` writes it, `load` reads it and `draw` draws it.

    `columns` as in Trajectory (SI, world axes); `pairs` body indices (o, f) of each contact with
    shapes, which the limits of joints follow; `faces` the outlines of faces that rested
    (report/resting_face_outlines.py); `meshes` the touching surfaces of contact k as "k_o" and "k_f",
    (rows, columns, 3) m in axes of the body's centre of mass; `summary` what `simulate --json` prints, less
    the files written; `scene` its tables (report/recorded_scene.py), None where they are not known.
    """

    columns: dict[str, Array]
    body_names: tuple[str, ...]
    contact_names: tuple[str, ...]
    pairs: Array
    meshes: dict[str, Array]
    summary: dict[str, Any]
    joint_names: tuple[str, ...] = ()
    coordinate_names: tuple[str, ...] = ()
    sensor_names: tuple[str, ...] = ()
    patch_names: tuple[str, ...] = ()
    shares: tuple[tuple[int, str], ...] = ()
    faces: dict[str, Array] = field(default_factory=dict)
    scene: dict[str, Any] | None = None

    def __repr__(self) -> str:
        """Name of the scene, outcome and sizes; no arrays."""
        run, samples = self.summary, len(self.columns["t"])
        return f"<Record {run['scene']}: {run['outcome']} at t = {run['t_end']:.6g} s; samples: {samples}>"

    def scene_again(self, what: str) -> Scene:
        """The scene of the run, with the values of its parameters; ModelgenError for `what` where the record
        does not hold it."""
        return read_again(self.scene, self.summary["parameters"], what)

    @property
    def moving(self) -> list[int]:
        """Indices of the bodies that move at all."""
        moved = np.zeros(len(self.body_names), dtype=bool)
        for name in ("p", "quaternion"):
            column = self.columns[name]
            moved |= (column != column[:1]).any(axis=(0, 2))
        return [int(i) for i in np.flatnonzero(moved)]

    @property
    def has_friction(self) -> bool:
        """Whether any contact or face ever slipped, or felt friction."""
        names = "friction", "contact_torque", "slip", "patch_friction", "patch_slip"
        return any(bool(self.columns[name].any()) for name in names)

    @property
    def rested(self) -> list[int]:
        """The patches that ever rested, as indices into `patch_names`."""
        return sorted({int(k) for k in self.columns["patch"].ravel()} - {-1})

    def pressure_curve(self, patch: int) -> Array:
        """(n, 2) m: the centre of pressure of a patch in the axes of f's face, NaN where it does not rest."""
        body, axes = int(self.faces[f"{patch}_body"][0]), self.faces[f"{patch}_axes"]
        mine = (self.columns["patch"] == patch)[..., None]
        points = np.where(mine, self.columns["patch_point"], np.nan)
        present = points[np.arange(len(points)), np.argmax(mine[..., 0], axis=1)]
        local = rotate_inverse(self.columns["quaternion"][:, body], present - self.columns["p"][:, body])
        curve: Array = (local - axes[:3]) @ axes[3:9].reshape(2, 3).T
        return curve

    def contact_curve(self, contact: int, side: str) -> Array:
        """(n, 3) m: the contact point on side "o" or "f" in axes of that body's centre of mass."""
        body = int(self.pairs[contact, 0 if side == "o" else 1])
        lever = self.columns[f"points_{side}"][:, contact] - self.columns["p"][:, body]
        return rotate_inverse(self.columns["quaternion"][:, body], lever)


def rotate_inverse(quaternion: Array, x: Array) -> Array:
    """R^T x for unit quaternions (n, 4) in (w, x, y, z) order and vectors (n, 3)."""
    w, axis = quaternion[:, :1], -quaternion[:, 1:]
    inner = 2.0 * np.cross(axis, x)
    rotated: Array = x + w * inner + np.cross(axis, inner)
    return rotated


def record_of(trajectory: Trajectory, library: Library, scene: Scene | None = None) -> Record:
    """The record of a run and of the library that made it: what `save` and `draw` take.

    With the scene, as `read` returned it, the record holds its tables; pages of the run need them.
    """
    expect("record_of", trajectory, Trajectory)
    expect("record_of", library, Library)
    if scene is not None:
        expect("record_of", scene, Scene)
    kept = kept_scene(scene, library)
    library = with_parameters(library, trajectory.parameters)
    instance = library.manifest.instance
    feature_pairs = [feature_pair_of(instance, k) for k in range(len(instance["contacts"]))]
    bare = Record(
        columns=ByName(
            {name: np.asarray(getattr(trajectory, name), dtype=float) for name in COLUMNS}, "column"
        ),
        body_names=trajectory.body_names,
        contact_names=trajectory.contact_names,
        pairs=np.array(
            [(feature_pair["o"], feature_pair["f"]) for feature_pair in feature_pairs], dtype=int
        ).reshape(-1, 2),
        meshes={},
        summary=ByName(trajectory.summary(), "summary"),
        joint_names=trajectory.joint_names,
        coordinate_names=trajectory.coordinate_names,
        sensor_names=trajectory.sensor_names,
        patch_names=trajectory.patch_names,
        shares=trajectory.shares,
        scene=kept,
    )
    bare.faces.update(face_outlines(library, bare.rested))
    bare.meshes.update(contact_meshes(library, bare.contact_curve))
    return bare
