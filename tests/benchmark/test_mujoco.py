"""What a peer makes of a scene: the same motion where it can represent it, else what it cannot."""

from __future__ import annotations

from pathlib import Path

import pytest

from modelgen import measure, read
from modelgen.benchmark.peers.mjcf import unlike
from modelgen.benchmark.work_precision_front import is_measured, place
from modelgen.scene.read import read_text
from tests.running import SCENES

pytestmark = pytest.mark.peers
mujoco = pytest.importorskip("mujoco")

FEW = ["tolerance", "timestep"]


def box(text: str) -> str:
    return f"""
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}

[[body]]
name = "solid"
density = 500.0
position = [0.0, 0.0, 2.0]
rpy = [0.3, 0.2, 0.1]
velocity = [0.5, 0.1, 0.0]
angular_velocity = [1.0, 2.0, 3.0]
{text}

[[contact]]
between = ["solid", "floor"]
"""


@pytest.mark.parametrize(
    "shape",
    [
        'shape = { kind = "box", size = [0.2, 0.3, 0.1] }',
        'shape = { kind = "cylinder", radius = 0.1, length = 0.3 }',
        'shape = { kind = "ellipsoid", semi_axes = [0.2, 0.1, 0.1], position = [0.1, 0.0, 0.0] }',
    ],
    ids=["box", "cylinder", "ellipsoid beside the origin"],
)
def test_a_body_in_flight_flies_the_same_way(shape: str, tmp_path: Path) -> None:
    """Without touching, masses, inertias, frames and starts alone decide."""
    scene = read_text(box(shape), "flight.toml")
    found = measure(scene, until=0.2, samples=4, knobs=FEW, against=["mujoco"], count=False, root=tmp_path)
    (peer,) = found.peers
    assert not peer.cannot
    assert min(place(point)[1] for point in peer.points if is_measured(point)) < 1e-9


def test_an_ellipsoid_on_a_plane_rocks_the_same_way(tmp_path: Path) -> None:
    scene = read(SCENES / "ellipsoid_on_plane.toml")
    found = measure(scene, until=0.2, samples=4, knobs=FEW, against=["mujoco"], count=False, root=tmp_path)
    (peer,) = found.peers
    assert place(peer.front[-1])[1] < 1e-4
    facts = peer.advantage(found.points)
    assert facts is not None
    assert facts["cheaper"] > 100
    assert facts["digits"] > 6


def test_a_force_pushes_the_same_way(tmp_path: Path) -> None:
    """Forces and torques of the time, in world and body axes, away from the centre."""
    loads = """
[[force]]
body = "solid"
force = ["20*t", 3.0, "5*cos(9*t)"]
point = [0.05, 0.0, 0.02]

[[torque]]
body = "solid"
torque = ["t", 0.2, "-0.1"]
frame = "body"
"""
    scene = read_text(box('shape = { kind = "box", size = [0.2, 0.3, 0.1] }') + loads, "pushed.toml")
    found = measure(scene, until=0.2, samples=4, knobs=FEW, against=["mujoco"], count=False, root=tmp_path)
    assert min(place(point)[1] for point in found.peers[0].points if is_measured(point)) < 1e-8


def test_a_spring_pulls_the_same_way(tmp_path: Path) -> None:
    spring = """
[[spring]]
between = ["solid", "floor"]
anchors = [[0.1, 0.0, 0.0], [0.0, 0.0, 1.0]]
stiffness = 40.0
damping = 0.5
rest_length = 0.5
"""
    scene = read_text(box('shape = { kind = "box", size = [0.2, 0.3, 0.1] }') + spring, "sprung.toml")
    found = measure(scene, until=0.2, samples=4, knobs=FEW, against=["mujoco"], count=False, root=tmp_path)
    assert min(place(point)[1] for point in found.peers[0].points if is_measured(point)) < 1e-8


def test_rings_hang_in_each_other(tmp_path: Path) -> None:
    scene = read(SCENES / "linked_rings.toml")
    found = measure(scene, until=0.1, samples=4, knobs=FEW, against=["mujoco"], count=False, root=tmp_path)
    (peer,) = found.peers
    assert "circles are chains of capsules" in peer.differs
    assert place(peer.front[-1])[1] < 3e-2


def test_a_ball_comes_back_as_fast_as_it_should(tmp_path: Path) -> None:
    text = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
density = 1000.0
position = [0.0, 0.0, 0.15]
velocity = [0.0, 0.0, -1.0]
shape = { kind = "sphere", radius = 0.1 }

[[contact]]
between = ["ball", "floor"]
restitution = 0.9
"""
    scene = read_text(text, "bounce.toml")
    found = measure(scene, until=0.15, samples=3, knobs=FEW, against=["mujoco"], count=False, root=tmp_path)
    assert place(found.peers[0].front[-1])[1] < 3e-3


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("linked_rings", []),
        ("rolling_disc", []),
        ("glass_on_table", []),
        ("bouncing_ball", []),
        ("peg_in_hole", ["shape hole/cylinder is a cavity"]),
        ("ellipsoid_in_cavity", ["shape cave/ellipsoid is a cavity"]),
        ("turntable", ["body 'table' is driven along a path", "shape table/plane is a plane that moves"]),
        ("ellipsoid_on_ellipsoid", []),
    ],
)
def test_what_it_cannot_represent_is_said_by_name(name: str, words: list[str]) -> None:
    assert unlike(read(SCENES / f"{name}.toml")) == words


def test_knobs_that_turn_none_of_its_settings_give_no_ratio(tmp_path: Path) -> None:
    scene = read(SCENES / "ellipsoid_on_plane.toml")
    options = {"until": 0.02, "samples": 2, "against": ["mujoco"], "count": False, "root": tmp_path}
    (peer,) = measure(scene, knobs=["tolerance"], **options).peers  # type: ignore[arg-type]
    assert peer.turned == ["timestep"]
    assert "contact" in peer.left
    assert peer.advantage(peer.points) is None
    (peer,) = measure(scene, knobs=["tolerance", "solver"], **options).peers  # type: ignore[arg-type]
    assert peer.turned == ["timestep", "solver"]
    assert peer.advantage(peer.points) is not None
