"""What is drawn of the shapes is where they touch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from modelgen import record_of, simulate
from tests.running import scene_of


@pytest.mark.parametrize(("name", "spacing"), [("egg_on_spline", 0.03), ("coin_in_bowl", 0.01)])
def test_contact_points_lie_on_what_is_drawn(name: str, spacing: float) -> None:
    """Splines with all their cells, solids with their edges."""
    library = scene_of(name)
    record = record_of(simulate(library, until=0.5, samples=50), library)
    for side in "of":
        mesh, curve = record.meshes[f"0_{side}"].reshape(-1, 3), record.contact_curve(0, side)
        drawn = cKDTree(mesh[np.isfinite(mesh).all(axis=1)])
        assert drawn.query(curve[np.isfinite(curve).all(axis=1)])[0].max() < spacing


def test_a_solid_is_drawn_within_itself() -> None:
    """The side of the peg ends at its rims."""
    library = scene_of("peg_in_hole")
    record = record_of(simulate(library, until=0.1, samples=5), library)
    side = "of"[record.pairs[0].tolist().index(record.body_names.index("peg"))]
    drawn = np.nanmax(np.abs(record.meshes[f"0_{side}"]), axis=(0, 1))
    touched = np.nanmax(np.abs(record.contact_curve(0, side)), axis=0)
    assert drawn.max() < 1.001 * touched.max()
