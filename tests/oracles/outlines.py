"""Outlines of extrusions with teeth, tips and hollows."""

from __future__ import annotations

from math import pi

import numpy as np

from tests.benchmarks.cliff_scenes import pallet_corners, wheel_corners

Array = np.ndarray


def ring_of_points(points: int, tip: float, root: float, lean: float = 0.0) -> Array:
    """(2 points, 2) m: tips, turned by `lean` rad against the roots between them."""
    angles = pi * np.arange(2 * points) / points + np.where(np.arange(2 * points) % 2, 0.0, lean)
    radii = np.where(np.arange(2 * points) % 2, root, tip)
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


WEDGE = np.array(pallet_corners(1))
OUTLINES = {
    "wheel": np.array(wheel_corners()),
    "wedge": WEDGE - WEDGE.mean(axis=0),
    "saw": ring_of_points(8, 0.05, 0.03, 0.3),
    "star": ring_of_points(5, 0.05, 0.015),
    "rectangle": np.array([[-0.02, -0.01], [0.02, -0.01], [0.02, 0.01], [-0.02, 0.01]]),
    "sliver": np.array([[-0.03, -0.001], [0.03, 0.0], [-0.03, 0.001]]),
    "hook": np.array([[0, 0], [4, 0], [4, 4], [3, 4], [3, 1], [0, 1]]) / 100 - 0.015,
}
