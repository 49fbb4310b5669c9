"""Which faces may rest on each other, and which do at the start."""

from __future__ import annotations

from rich.console import Console

from modelgen.assembly.characteristic_scales import flush_height
from modelgen.geometry.face_regions import in_one_plane
from modelgen.model import Model, PatchEntry
from modelgen.name_suggestions import listed
from modelgen.scene.pose_arithmetic import UPSIDE_DOWN, compose
from modelgen.scene.scene_types import Pose

SHOWN = 3  # pairs of faces named in a row; the rest is counted


def patch_names(model: Model) -> tuple[list[str], list[str]]:
    """All patches, those whose faces are in one plane at the start first; these alone."""
    level = [entry.name for entry in model.patches if _is_level(model, entry)]
    return level + [entry.name for entry in model.patches if entry.name not in level], level


def _is_level(model: Model, entry: PatchEntry) -> bool:
    o, f = (model.faces[k] for k in entry.faces)
    bodies = model.scene.bodies
    facing = compose(bodies[f.body].pose, compose(f.pose, Pose(quaternion=UPSIDE_DOWN)))
    return in_one_plane(compose(bodies[o.body].pose, o.pose), facing, flush_height(model.scene, model.scales))


def print_patches(console: Console, names: list[str], level: list[str]) -> None:
    """The faces of each pair that rest as one planar contact, the first few by name."""
    pairs: dict[str, list[str]] = {}
    for name in names:
        pair, _, faces = name.rpartition(":")
        label = faces.replace("-", " on ")
        pairs.setdefault(pair, []).append(f"{label} (at the start)" if name in level else label)
    for name, labels in pairs.items():
        text = f"{name}: faces that can rest as one planar contact: {listed(labels, SHOWN)}"
        console.print(text, markup=False, soft_wrap=True)
