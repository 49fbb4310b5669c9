"""Scenes in MuJoCo and here, measured together (extra `peers`).

Run with `python -m tests.benchmarks.against_mujoco [SCENE...]`: the table that `modelgen measure SCENE
--against mujoco` prints, for scenes that MuJoCo can represent. Its knobs are in modelgen/measure/mujoco.py.
"""

from __future__ import annotations

import sys

from rich.console import Console

from modelgen import measure, read
from modelgen.measure.table import print_measurement
from tests.running import SCENES, folder

REPRESENTED = ("ellipsoid_on_plane", "ellipsoid_on_ellipsoid")


def main(names: tuple[str, ...]) -> None:
    for name in names or REPRESENTED:
        scene = read(SCENES / f"{name}.toml")
        print_measurement(measure(scene, against=["mujoco"], root=folder()), Console())


if __name__ == "__main__":
    main(tuple(sys.argv[1:]))
