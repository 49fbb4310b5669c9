"""`--to mjcf` and `--to urdf`: what can be said in them is said alike, and the rest is refused by name."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from modelgen import derive, require, simulate
from modelgen.errors import ModelgenError
from modelgen.export.export_formats import Choices, export
from modelgen.export.urdf_file import rpy_of
from modelgen.rotations import rotation_of
from modelgen.scene.pose_input import _from_rpy
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Pose
from tests.c_compiler import needs_c
from tests.export.folders import exported
from tests.running import scene_of

ARM = """
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "base"
motion = "fixed"
position = [0.1, 0.2, 0.3]
shape = { kind = "box", size = [0.2, 0.2, 0.1] }

[[body]]
name = "arm"
mass = 1.0
inertia = [0.01, 0.02, 0.03]
position = [0.1, 0.7, 0.3]
shape = { kind = "cylinder", radius = 0.05, length = 0.8, rpy = [1.5707963267948966, 0, 0] }

[[joint]]
name = "shoulder"
kind = "revolute"
between = ["base", "arm"]
position = [0.1, 0.2, 0.3]
"""


def folder_of(text: str, to: str, tmp_path: Path) -> Path:
    export(derive(require(read_text(text, "arm.toml"))), to, tmp_path, tmp_path / ".library", Choices())
    return tmp_path


@pytest.mark.parametrize(
    ("name", "to", "told"),
    [
        ("rolling_disc", "urdf", "shape table/plane is a plane; shape coin/circle is a circle"),
        ("four_bar", "mjcf", "joint '.*' is not exported"),
        ("linked_rings", "urdf", "is a circle"),
        ("turntable", "mjcf", "is driven along a path"),
    ],
)
def test_what_a_format_has_no_like_of_is_refused_by_name(
    name: str, to: str, told: str, tmp_path: Path
) -> None:
    with pytest.raises(ModelgenError, match=told):
        exported(name, to, tmp_path)


@pytest.mark.parametrize(
    "rpy", [(0.3, -1.2, 2.5), (0.0, 0.0, -3.0), (0.4, np.pi / 2, 0.1), (1.0, -np.pi / 2, 0.5)]
)
def test_roll_pitch_and_yaw_turn_as_the_quaternion_does(rpy: tuple[float, float, float]) -> None:
    pose = Pose((0.0, 0.0, 0.0), _from_rpy(rpy))
    again = rotation_of(_from_rpy(rpy_of(pose)))
    assert again == pytest.approx(rotation_of(pose.quaternion), abs=1e-11)


@needs_c
def test_mujoco_places_the_links_of_a_urdf_where_the_scene_has_its_bodies(tmp_path: Path) -> None:
    file = folder_of(ARM, "urdf", tmp_path) / "arm.urdf"
    root = ElementTree.parse(file).getroot()
    assert [each.get("type") for each in root.iter("joint")] == ["fixed", "continuous"]
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.nv == 1
    assert data.xipos[model.body("arm").id] == pytest.approx([0.1, 0.7, 0.3], abs=1e-12)


HINGE = """
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "{base}"
motion = "fixed"
position = [0.1, 0.2, 0.3]
shape = {{ kind = "box", size = [0.2, 0.2, 0.1] }}
[[body]]
name = "{arm}"
mass = 1.0
inertia = [0.01, 0.02, 0.03]
position = [0.1, 0.7, 0.3]
[[body]]
name = "ball"
mass = 1.0
inertia = [0.01, 0.01, 0.01]
position = [1.0, 0.0, 0.0]
[[joint]]
name = "{joint}"
kind = "revolute"
between = {between}
position = [0.1, 0.2, 0.3]
limits = [-0.5, 1.0]
"""


@needs_c
@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize(
    ("base", "arm", "joint"),
    [
        ("base", "arm", "shoulder"),
        ("world", "arm", "world_ball"),
        ("base", "world", "world"),
        ("world", "world_", "world_world_"),
    ],
)
def test_names_of_a_scene_and_the_order_of_joints_are_free(
    base: str, arm: str, joint: str, is_turned: bool, tmp_path: Path
) -> None:
    """MuJoCo has a body `world` of its own; what is fixed holds the rest, whichever a joint names first."""
    mujoco = pytest.importorskip("mujoco")
    between = [arm, base] if is_turned else [base, arm]
    text = HINGE.format(base=base, arm=arm, joint=joint, between=between)
    model = mujoco.MjModel.from_xml_path(str(folder_of(text, "urdf", tmp_path) / "arm.urdf"))
    data, angle = mujoco.MjData(model), 0.3
    at = int(model.jnt_qposadr[model.joint(joint).id])
    data.qpos[at] = angle
    mujoco.mj_forward(model, data)
    assert model.nv == 7
    assert list(model.joint(joint).range) == [-0.5, 1.0]
    turn = -angle if is_turned else angle
    (found,) = [p for p, mass in zip(data.xipos, model.body_mass, strict=True) if mass and p[0] < 0.5]
    assert found == pytest.approx([0.1 - 0.5 * np.sin(turn), 0.2 + 0.5 * np.cos(turn), 0.3], abs=1e-12)


@needs_c
@pytest.mark.parametrize("name", ["ball", "world"])
def test_a_body_of_any_name_is_in_mjcf(name: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    text = f"""
    [[body]]
    name = "floor"
    motion = "fixed"
    shape = {{ kind = "plane" }}
    [[body]]
    name = "{name}"
    shape = {{ kind = "sphere", radius = 0.1 }}
    density = 1000.0
    position = [0.0, 0.0, 0.1]
    [[contact]]
    between = ["floor", "{name}"]
    """
    file = folder_of(text, "mjcf", tmp_path) / "arm.xml"
    model = mujoco.MjModel.from_xml_path(str(file))
    assert {model.body(k).name for k in range(model.nbody)} == {
        "world",
        "floor",
        name.replace("world", "world_"),
    }
    assert ("body world is called world_" in file.read_text()) == (name == "world")


@needs_c
@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["ellipsoid_on_plane", "sphere_slide_to_roll", "ellipsoid_on_ellipsoid", "linked_rings"]
)
def test_mujoco_approaches_the_run_as_its_step_shrinks(name: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    until, errors = 0.2, []
    path = simulate(scene_of(name), until=until, samples=10, estimate=False)
    for step in (1e-3, 1e-4, 1e-5):
        file = exported(name, "mjcf", tmp_path, step=step) / f"{name}.xml"
        model = mujoco.MjModel.from_xml_path(str(file))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        mujoco.mj_step(model, data, nstep=round(until / step))
        moving = [k for k, body in enumerate(path.body_names) if model.body(body).dofnum[0]]
        found = [data.xipos[model.body(path.body_names[k]).id] for k in moving]
        errors.append(float(np.abs(np.array(found) - path.p[-1, moving]).max()))
    assert errors[-1] < 1e-4
    assert errors[-1] < errors[0]
