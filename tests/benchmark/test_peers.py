"""What other simulators make of a scene: the same motion, or what they cannot represent."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from modelgen.benchmark.measurement import Measurement, measure
from modelgen.benchmark.peers import PEERS, drake, exudyn, siconos, simbody
from modelgen.benchmark.work_precision_front import is_measured, place
from modelgen.errors import ModelgenError
from modelgen.scene.read import read, read_text
from modelgen.scene.scene_types import Scene
from tests.running import SCENES

SHORT = {"until": 0.05, "samples": 4, "count": False}

pytestmark = pytest.mark.usefixtures("hasty")


def coarse(peer: str) -> list[str]:
    """The ladders alone."""
    return ["tolerance", *(knob.name for knob in PEERS[peer].knobs if knob.ladder)]


def against(scene: Scene, peer: str, root: Path) -> Measurement:
    try:
        return measure(scene, knobs=coarse(peer), against=[peer], root=root, **SHORT)  # type: ignore[arg-type]
    except ModelgenError as absent:
        if "not installed" not in str(absent):
            raise
        pytest.skip(str(absent))


@pytest.mark.peers
@pytest.mark.parametrize(
    ("peer", "scene", "error"),
    [
        ("drake", "ellipsoid_on_plane", 1e-3),
        ("exudyn", "rolling_disc", 1e-6),
        ("siconos", "ellipsoid_on_plane", 1e-2),
        ("simbody", "ellipsoid_on_plane", 1e-3),
    ],
)
def test_it_moves_as_here(peer: str, scene: str, error: float, tmp_path: Path) -> None:
    (found,) = against(read(SCENES / f"{scene}.toml"), peer, tmp_path).peers
    assert not found.cannot
    assert found.version
    assert min(place(point)[1] for point in found.points if is_measured(point)) < error


@pytest.mark.parametrize(
    ("unlike", "name", "words"),
    [
        (drake.unlike, "linked_rings", []),
        (drake.unlike, "glass_on_table", ["loads are not exported"]),
        (drake.unlike, "ellipsoid_in_cavity", ["shape cave/ellipsoid is a cavity"]),
        (exudyn.unlike, "rolling_disc", []),
        (
            exudyn.unlike,
            "ellipsoid_on_plane",
            ["contact 0 is of a ellipsoid with a plane: it has rims on planes and spheres"],
        ),
        (siconos.unlike, "rolling_disc", []),
        (
            siconos.unlike,
            "linked_rings",
            ["contact 0 is not of a sphere, an ellipsoid or a circle on a fixed plane"],
        ),
        (simbody.unlike, "ellipsoid_on_ellipsoid", []),
        (simbody.unlike, "rolling_disc", ["shape coin/circle is a circle"]),
    ],
)
def test_what_a_simulator_cannot_represent_is_said(
    unlike: Callable[[Scene], list[str]], name: str, words: list[str]
) -> None:
    assert unlike(read(SCENES / f"{name}.toml")) == words


def test_a_driven_body_is_refused_by_all() -> None:
    scene = read(SCENES / "turntable.toml")
    for unlike in (drake.unlike, exudyn.unlike, siconos.unlike, simbody.unlike):
        assert any("driven" in sentence for sentence in unlike(scene))


@pytest.mark.parametrize("name", list(PEERS))
def test_one_that_is_missing_is_named_before_anything_is_measured(name: str, tmp_path: Path) -> None:
    try:
        PEERS[name].find()
        pytest.skip(f"{name} is installed")
    except ModelgenError:
        pass
    scene = read_text(
        '[[body]]\nname = "ball"\ndensity = 1.0\nshape = { kind = "sphere", radius = 0.1 }\n', "ball.toml"
    )
    with pytest.raises(ModelgenError, match=f"--against: {name} is not installed.*install"):
        measure(scene, knobs=coarse(name), against=[name], root=tmp_path, **SHORT)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())
