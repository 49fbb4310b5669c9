"""Files that are none of their format, in one message and without a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest

from modelgen import ModelgenError, import_scene

ROBOT = '<robot name="r"><link name="a"/></robot>'
LINE = "\n".join(f"{k},{2 * k}" for k in range(99))
PROFILES = {
    "": "0 points",
    "\n\n": "0 points",
    "x,y\n": "0 points",
    "0,0\n1,\n2,3\n": "line 2: '1 '; two numbers",
    ",\n,\n": "line 1",
    LINE: "points on a line; an outline around an area",
    "\n".join(f"{k}e302,{k * k % 7}e302" for k in range(99)): "a coordinate of .*e.303 m; at most 1e.09 m",
}


@pytest.mark.parametrize("content", PROFILES)
def test_a_profile_without_an_outline_is_refused(content: str, tmp_path: Path) -> None:
    path = tmp_path / "profile.csv"
    path.write_text(content)
    with pytest.raises(ModelgenError, match=PROFILES[content]):
        import_scene(path, kind="extrusion")


@pytest.mark.parametrize("encoding", ["shift_jis", "gbk", "utf-7", "nonsense", "idna", "rot13", "base64"])
@pytest.mark.parametrize("format", [None, "urdf"])
def test_a_robot_in_an_encoding_that_is_not_read_is_refused(
    encoding: str, format: str | None, tmp_path: Path
) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(f'<?xml version="1.0" encoding="{encoding}"?>{ROBOT}')
    with pytest.raises(ModelgenError, match=r"robot\.urdf"):
        import_scene(path, format)


@pytest.mark.parametrize("name", ["robot.urdf", "robot.xml"])
def test_a_deep_file_is_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text("<mujoco>" + "<body>" * 10**5 + "</body>" * 10**5 + "</mujoco>")
    with pytest.raises(ModelgenError):
        import_scene(path)
