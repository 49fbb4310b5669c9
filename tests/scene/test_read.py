"""Scene files: sound ones are read as written, broken ones give one message with place and remedy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import modelgen.scene as scene_package
from modelgen.errors import SceneError
from modelgen.scene.read import LARGEST, read, read_text

from .broken_meaning import MEANING
from .broken_structure import SOUND, STRUCTURAL, egg


@pytest.mark.parametrize(
    ("text", "fragments"), [pytest.param(*case[1:], id=case[0]) for case in STRUCTURAL + MEANING]
)
def test_a_broken_scene_gives_one_message_with_place_and_remedy(text: str, fragments: list[str]) -> None:
    with pytest.raises(SceneError) as caught:
        read_text(text, "broken.toml")
    message = str(caught.value)
    assert message.startswith("broken.toml: ")
    assert "\n" not in message
    assert caught.value.allowed or caught.value.remedy
    for fragment in fragments:
        assert fragment in message


def test_a_sound_scene_is_read_as_written() -> None:
    scene = read_text(SOUND, "drop.toml")
    assert (scene.name, scene.source) == ("drop", "drop.toml")
    assert [body.motion for body in scene.bodies] == ["fixed", "dynamic"]
    assert scene.bodies[1].shapes[0].parameters == (("radius", 0.1),)
    assert scene.contacts[0].between == (("egg", "sphere"), ("table", "plane"))
    assert scene.gravity == (0.0, 0.0, -9.81)
    assert scene.run.until == 1.0


def test_constants_stand_for_their_values_in_numbers_and_expressions() -> None:
    """In any order; they go before nothing of the user's own, and the scene is the one with the values."""
    named = read_text(
        """
gravity = [0, 0, "-g"]
[constants]
area = "pi*radius**2"
radius = "diameter/2"
diameter = 0.2
g = 9.81
n = 5
k = 3.0
[run]
samples = "2*n"
[[body]]
name = "ball"
shape = { kind = "sphere", radius = "radius" }
density = "area*100"
[[body]]
name = "sheet"
motion = "driven"
path = { position = ["radius*t", 0, 0] }
[body.shape]
kind = "chart"
x = "u"
y = "v"
z = "h*sin(k*u) + radius"
domain = [["-2*radius", 1], [-1, "n"]]
parameters = { h = "radius/10", k = 7 }
[[contact]]
between = ["ball", "sheet"]
"""
    )
    plain = read_text(
        """
[run]
samples = 10
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
density = "pi*0.1**2*100"
[[body]]
name = "sheet"
motion = "driven"
path = { position = ["0.1*t", 0, 0] }
[body.shape]
kind = "chart"
x = "u"
y = "v"
z = "h*sin(k*u) + 0.1"
domain = [[-0.2, 1], [-1, 5]]
parameters = { h = 0.01, k = 7 }
[[contact]]
between = ["ball", "sheet"]
"""
    )
    assert named.run == plain.run
    assert named.gravity == plain.gravity
    assert named.bodies[0] == plain.bodies[0]
    chart, same = named.bodies[1].shapes[0], plain.bodies[1].shapes[0]
    assert chart.parameters == same.parameters
    assert chart.chart is not None
    assert same.chart is not None
    assert chart.chart.domain == same.chart.domain
    trees = [[each.tree for each in shape.components] for shape in (chart.chart, same.chart)]
    assert trees[0] == trees[1]
    paths = [body.path.position[0].tree for body in (named.bodies[1], plain.bodies[1]) if body.path]
    assert paths[0] == paths[1]


def test_every_key_reaches_the_scene() -> None:
    scene = read_text(
        """
gravity = [0, 1, "-sqrt(2)"]
observe = ["a.orientation"]
fold = true
run = { until = 2, accuracy = "tight", tolerance = 1e-9, samples = 7 }
[[body]]
name = "lift"
motion = "driven"
position = [0, 0, 1]
path = { position = [0, "0.1*sin(2*pi*t)", 0], rotation_vector = [0, 0, "t"] }
[[body.shape]]
kind = "plane"
[[body.shape]]
kind = "ellipsoid"
name = "lid"
semi_axes = [3, 2, 1]
cavity = true
position = [0, 0, 2]
[[body]]
name = "a"
shape = { kind = "sphere", radius = 1 }
density = 2
velocity = [1, 2, 3]
angular_velocity = [4, 5, 6]
[[contact]]
between = ["a", "lift/lid"]
restitution = 0.5
form = "explicit"
[[spring]]
between = ["a", "lift"]
anchors = [[1, 0, 0], [0, 1, 0]]
stiffness = 3
damping = 4
rest_length = 5
[[force]]
body = "a"
force = ["-vx", 0, "t*qw"]
point = [0, 0, 1]
frame = "body"
[[torque]]
body = "a"
torque = [0, 0, "wz"]
"""
    )
    lift, a = scene.bodies
    assert scene.gravity == (0.0, 1.0, -(2.0**0.5))
    assert (scene.observe, scene.fold) == (("a.orientation",), True)
    assert (scene.run.until, scene.run.accuracy, scene.run.tolerance, scene.run.samples) == (
        2.0,
        "tight",
        1e-9,
        7,
    )
    assert lift.path is not None
    assert lift.path.position[1].names == {"t"}
    assert [shape.name for shape in lift.shapes] == ["plane", "lid"]
    assert lift.shapes[1].cavity
    assert lift.shapes[1].pose.position == (0.0, 0.0, 2.0)
    assert (a.density, a.mass, a.velocity, a.angular_velocity) == (2.0, None, (1, 2, 3), (4, 5, 6))
    assert scene.contacts[0].between == (("a", "sphere"), ("lift", "lid"))
    assert (scene.contacts[0].restitution.value, scene.contacts[0].form) == (0.5, "explicit")
    force, torque, spring = scene.loads
    assert (force.frame, force.point, force.components[2].text) == ("body", (0, 0, 1), "t*qw")  # type: ignore[union-attr]
    assert (torque.body, torque.frame) == ("a", "world")  # type: ignore[union-attr]
    assert (spring.stiffness, spring.damping, spring.rest_length) == (3, 4, 5)  # type: ignore[union-attr]


angles = st.floats(-3.1, 3.1)


@given(roll=angles, pitch=angles, yaw=angles)
def test_the_four_ways_to_write_an_orientation_agree(roll: float, pitch: float, yaw: float) -> None:
    expected = Rotation.from_euler("xyz", [roll, pitch, yaw])
    matrix = expected.as_matrix()
    turn = expected.as_rotvec()
    axis = turn.tolist() if np.linalg.norm(turn) > 1e-3 else [0, 0, 1]
    angle = float(np.linalg.norm(turn)) if np.linalg.norm(turn) > 1e-3 else 0.0
    x, y, z, w = (3 * expected.as_quat()).tolist()
    written = [
        f"rpy = {[roll, pitch, yaw]}",
        f"rotation = {matrix.tolist()}",
        f"axis_angle = {{ axis = {axis}, angle = {angle} }}",
        f"quaternion = {[w, x, y, z]}",
    ]
    for text in written[: 4 if angle else 2]:
        w, x, y, z = read_text(egg(text)).bodies[1].pose.quaternion
        assert np.abs(Rotation.from_quat([x, y, z, w]).as_matrix() - matrix).max() < 1e-14
        assert abs(w * w + x * x + y * y + z * z - 1) < 1e-15


def test_an_inertia_of_three_moments_is_the_diagonal_matrix() -> None:
    moments = read_text(egg("", mass="mass = 1\ninertia = [1, 1, 2]\n"))
    matrix = read_text(egg("", mass="mass = 1\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 2]]\n"))
    assert moments.bodies[1].inertia == matrix.bodies[1].inertia == ((1, 0, 0), (0, 1, 0), (0, 0, 2))


class TestFiles:
    def test_a_missing_file_names_the_nearest(self, tmp_path: Path) -> None:
        (tmp_path / "drop.toml").write_text(SOUND)
        with pytest.raises(SceneError, match=r"dorp\.toml: no such file; did you mean 'drop\.toml'\?"):
            read(tmp_path / "dorp.toml")

    def test_a_directory_is_not_a_scene(self, tmp_path: Path) -> None:
        with pytest.raises(SceneError, match=r"it is a folder; .*; give the path of a file"):
            read(tmp_path)

    def test_binary_junk_is_not_a_scene(self, tmp_path: Path) -> None:
        (tmp_path / "x.toml").write_bytes(b"\x7fELF\xff\xfe")
        with pytest.raises(
            SceneError, match=r"x\.toml: line 1 is not UTF-8 text; a scene is a TOML file; .* save it"
        ):
            read(tmp_path / "x.toml")

    def test_a_very_large_file_is_not_read(self, tmp_path: Path) -> None:
        with open(tmp_path / "x.toml", "wb") as file:
            file.truncate(LARGEST + 1)
        with pytest.raises(SceneError, match=f"{LARGEST + 1} bytes; a scene file has at most {LARGEST}"):
            read(tmp_path / "x.toml")

    def test_a_path_that_cannot_be_is_refused(self) -> None:
        with pytest.raises(SceneError):
            read("nul\0byte.toml")
        with pytest.raises(SceneError):
            read("x" * 5000)

    def test_byte_order_mark_and_windows_line_ends_are_read(self, tmp_path: Path) -> None:
        path = tmp_path / "a drop.toml"
        path.write_bytes(b"\xef\xbb\xbf" + SOUND.replace("\n", "\r\n").encode())
        assert read(path).name == "a_drop"


@given(st.text(max_size=200))
def test_any_text_is_a_scene_or_one_error(text: str) -> None:
    try:
        read_text(text)
    except SceneError:
        return
    raise AssertionError("no random text is a scene")


def test_the_example_of_the_package_is_a_scene() -> None:
    example = "\n".join(line[4:] for line in (scene_package.__doc__ or "").splitlines() if line[:4] == "    ")
    scene = read_text(example)
    assert scene.bodies[1].pose.quaternion == pytest.approx((0.5**0.5, 0, 0.5**0.5, 0), abs=1e-15)
    assert scene.run.until == 2.0


TWO_SHAPES = """
observe = ["OBSERVED.force", "pot.position"]
[[sensor]]
name = "gap"
of = "OBSERVED.gap"
[[sensor]]
name = "force"
of = "OBSERVED.force"
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "pot"
density = 1.0
position = [0, 0, 1]
[[body.shape]]
kind = "sphere"
radius = 0.1
[[body.shape]]
kind = "ellipsoid"
semi_axes = [0.1, 0.1, 0.2]
position = [1, 0, 0]
[[contact]]
between = ["pot/sphere", "floor"]
[[contact]]
between = ["pot/ellipsoid", "floor"]
"""


@pytest.mark.parametrize(
    ("own", "other"),
    [
        ("pot/sphere-floor/plane", "floor/plane-pot/sphere"),
        ("pot/ellipsoid-floor/plane", "floor/plane-pot/ellipsoid"),
    ],
)
def test_a_gap_or_force_of_a_pair_is_the_same_in_either_order(own: str, other: str) -> None:
    scenes = [read_text(TWO_SHAPES.replace("OBSERVED", name), "pairs.toml") for name in (own, other)]
    for scene in scenes:
        assert [each.measurand and each.measurand.name for each in scene.sensors] == [own, own]
        assert scene.observe == (f"{own}.force", "pot.position")
    for wrong in ("floor-cup", "pot/sphere-floor"):
        with pytest.raises(SceneError, match=f"no body, joint or pair named '{wrong}'"):
            read_text(TWO_SHAPES.replace("OBSERVED", wrong), "pairs.toml")
