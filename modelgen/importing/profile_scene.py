"""A measured profile as the text of a scene: one body whose shape is a spline of one feature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.importing.import_losses import Notes
from modelgen.importing.name_conversion import Names
from modelgen.importing.profile_file import read_points
from modelgen.importing.profile_fit import Array, Fitted, fit_profile
from modelgen.importing.scene_writing import Section, scene_text
from modelgen.name_suggestions import nearest

KINDS: Mapping[str, tuple[bool, str]] = {  # shape: whether its profile closes, and what its columns are
    "revolution": (False, "r, z"),
    "profile_wall": (False, "x, y"),
    "extrusion": (True, "x, y"),
}
DIGITS = 10  # of nodes after the point, in m


@dataclass(frozen=True)
class Reading:
    """How the file of a profile is read: see `Choices` of import_formats.py."""

    kind: str | None
    columns: str | None
    unit: str
    tolerance: float | None
    length: float | None


def profile_text(path: Path, reading: Reading, until: float, notes: Notes) -> str:
    """The text of a scene with the profile of a file; raises ModelgenError."""
    kind = _kind(reading)
    closed, _ = KINDS[kind]
    points, lines = read_points(path, reading.columns, reading.unit)
    fitted = fit_profile(points, closed, reading.tolerance, str(path))
    if fitted.outliers:
        told = ", ".join(str(lines[k]) for k in fitted.outliers[:10])
        more = " and others" if len(fitted.outliers) > 10 else ""
        notes.omit(f"{len(fitted.outliers)} points that lie off the others, of lines {told}{more}")
    notes.approximate(
        f"{len(points)} points are a spline through {len(fitted.nodes)}: rms deviation {fitted.rms:.2g} m, "
        f"largest {fitted.largest:.2g} m; their noise is {fitted.noise:.2g} m"
    )
    body = Section(
        "body", {"name": Names().of(path.stem, "profile"), "motion": "fixed"},
        inner=[Section("body.shape", shape_table(kind, fitted.nodes, reading.length))],
    )  # fmt: skip
    return scene_text(_head(path, fitted, notes), {}, [Section("run", {"until": until}, single=True), body])


def shape_table(kind: str, nodes: Array, length: float | None = None) -> dict[str, Any]:
    """The table of a shape with a profile through nodes (n, 2) m; a wall has its material inside its bend."""
    if kind == "profile_wall" and _turning(nodes) < 0:
        nodes = nodes[::-1]
    table: dict[str, Any] = {"kind": kind}
    if kind == "extrusion":
        table["smooth"] = True
    table["points"] = np.round(nodes, DIGITS).tolist()
    if kind != "revolution":
        table["length"] = 1.0 if length is None else length
    return table


def _kind(reading: Reading) -> str:
    allowed = "allowed: " + ", ".join(f"{kind} ({columns})" for kind, (_, columns) in KINDS.items())
    if reading.kind is None or reading.kind not in KINDS:
        found = "no shape" if reading.kind is None else repr(reading.kind)
        meant = "write --as revolution" if reading.kind is None else nearest(reading.kind, KINDS)
        raise ModelgenError("--as", found, allowed, meant)
    if reading.kind == "revolution" and reading.length is not None:
        raise ModelgenError(
            "--length", "it with a revolution", "it goes with the other shapes", "leave it out"
        )
    return reading.kind


def _turning(nodes: Array) -> float:
    """Angle by which the chain of nodes turns to the left, rad."""
    steps = np.diff(nodes, axis=0)
    a, b = steps[:-1], steps[1:]
    return float(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)).sum())


def _head(path: Path, fitted: Fitted, notes: Notes) -> list[str]:
    x, y = fitted.least_at
    return [
        f"{path.name}, a profile imported by modelgen.",
        *(f"- {sentence}" for sentence in notes.approximated),
        f"- least radius of curvature {fitted.least_radius:.3g} m, at ({x:.4g}, {y:.4g}) m",
        *(f"- left out: {sentence}" for sentence in notes.left_out),
    ]
