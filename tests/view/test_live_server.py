"""A run in the browser obeys its controls."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from socket import create_connection

import numpy as np
import pytest

from modelgen import read, require
from modelgen.errors import ModelgenError
from modelgen.runtime.stepped_simulation import start
from tests.running import SCENES, library_of, scene_of
from tests.view.browser import browser, needs_browser

pytest.importorskip("viser", reason="extra view")
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from modelgen.view.live_server import Live
from tests.view.malformed_messages import malformed


@pytest.fixture
def wheel() -> Iterator[Live]:
    live = Live(scene_of("balancing_wheel"), require(read(SCENES / "balancing_wheel.toml")), port=18080)
    yield live
    live.stop()


def test_a_live_run_is_the_run(wheel: Live) -> None:
    wheel.speed.value = "0.3"
    wheel.inputs["torque"].value = 0.5
    given = float(wheel.inputs["torque"].value)
    for _ in range(3):
        wheel.step(0.1)
    alone = start(scene_of("balancing_wheel"))
    alone.inputs["torque"] = given
    for _ in range(3):
        alone.step(until=alone.t + 0.1 * 0.3)
    assert np.array_equal(wheel.simulation.state, alone.state)
    wheel.running.value = False
    wheel.step(0.1)
    assert wheel.simulation.t == alone.t


def test_reset_and_a_parameter_start_anew(wheel: Live) -> None:
    wheel.step(0.1)
    wheel.ask_reset()
    wheel.running.value = False
    wheel.step(0.1)
    assert wheel.simulation.t == 0.0


THUMB = """(() => { const box = document.querySelector('.mantine-Slider-thumb').getBoundingClientRect();
return [box.x + box.width / 2, box.y + box.height / 2]; })()"""
PARAMETER = """
[[parameter]]
name = "radius"
value = 0.1
minimum = 0.05
maximum = 0.2

[[input]]
name = "height"
hold = "linear"

[[body]]
name = "lift"
motion = "driven"
shape = { kind = "plane" }
path = { position = ["0.0", "0.0", "height"] }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = "radius" }
density = 1000.0
position = [0.0, 0.0, 0.25]

[[contact]]
between = ["ball", "lift"]
restitution = 0.0
"""


def test_sliders_move_bodies() -> None:
    from modelgen.scene.read import read_text

    scene = read_text(PARAMETER, "lift.toml")
    live = Live(library_of(scene), require(scene), port=18090)
    try:
        live.step(0.1)
        live.inputs["height"].value = 0.05
        for _ in range(10):
            live.step(0.1)
        assert live.simulation.inputs["height"] == pytest.approx(float(live.inputs["height"].value))
        lifted = live.place("lift")
        assert lifted[2] == pytest.approx(float(live.inputs["height"].value))
        live.parameters["radius"].value = 0.15
        live.running.value = False
        live.step(0.1)
        assert live.simulation.t == 0.0
        live.running.value = True
        live.inputs["height"].value = 0.0
        for _ in range(10):
            live.step(0.1)
        assert live.place("ball")[2] == pytest.approx(float(live.parameters["radius"].value), abs=1e-6)
    finally:
        live.stop()


def test_a_start_that_is_refused_says_so() -> None:
    with pytest.raises(ModelgenError, match="push"):
        Live(
            scene_of("balancing_wheel"), require(read(SCENES / "balancing_wheel.toml")), inputs={"push": 1.0}
        )


@pytest.mark.slow
@needs_browser
def test_a_browser_shows_the_run(tmp_path: Path, wheel: Live) -> None:
    wheel.running.value = False
    with browser(tmp_path) as driven:
        driven.open(wheel.address)
        driven.until("document.querySelectorAll('canvas').length > 0")
        driven.until("document.body.innerText.includes('t = 0.0000 s')")
        before = driven.shot()
        wheel.running.value = True
        wheel.inputs["torque"].value = 1.0
        for _ in range(30):
            wheel.step(1 / 30)
        driven.until("document.body.innerText.includes('t = 1.0000 s')")
        driven.settle()
        after = driven.shot()
        x, y = driven.value(THUMB)
        driven.drag((x, y), (x - 40, y))
        end = time.monotonic() + 10
        while wheel.inputs["torque"].value == 1.0 and time.monotonic() < end:
            time.sleep(0.05)
        wheel.step(1 / 30)
        assert wheel.simulation.inputs["torque"] < 0
    assert (np.abs(before - after).max(axis=2) > 40).mean() > 0.005


def answer_to(live: Live, **headers: str) -> int:
    """The status of the answer to a request of the page with other headers."""
    address, port = live.address.removeprefix("http://").split(":")
    given = {"Host": f"{address}:{port}"} | headers
    with create_connection((address, int(port)), timeout=30) as line:
        lines = ["GET / HTTP/1.1", *(f"{name}: {value}" for name, value in given.items()), "", ""]
        line.sendall("\r\n".join(lines).encode())
        return int(line.recv(100).split()[1])


OWN = ("127.0.0.1:18080", "localhost:9000", "[::1]:18080", "192.168.1.5:18080")
FOREIGN = (
    "example.org",
    "example.org:18080",
    "127.0.0.1.example.org:18080",
    "localhost.example.org",
    "",
    "a b",
)


@pytest.mark.parametrize("name", OWN)
def test_the_page_is_served_under_own_names(wheel: Live, name: str) -> None:
    assert answer_to(wheel, Host=name) == answer_to(wheel, Host=name, Origin=f"http://{name}") == 200


@pytest.mark.parametrize("name", FOREIGN)
def test_foreign_names_and_origins_get_nothing(wheel: Live, name: str) -> None:
    upgrade = {
        "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Protocol": f"viser-v{viser.__version__}",
    }  # fmt: skip
    assert answer_to(wheel, **upgrade) == 101
    for headers in ({"Host": name}, {"Origin": f"http://{name}"}, {"Origin": "null"}):
        assert answer_to(wheel, **headers) == 403
        assert answer_to(wheel, **upgrade, **headers) == 403


@pytest.mark.parametrize("count", [100, pytest.param(1000, marks=pytest.mark.slow)])
def test_malformed_messages_end_their_connection_alone(
    wheel: Live, count: int, capfd: pytest.CaptureFixture[str]
) -> None:
    rng, address = np.random.default_rng(count), wheel.address.replace("http", "ws")
    for _ in range(count):
        with (
            connect(address, subprotocols=[f"viser-v{viser.__version__}"]) as line,
            suppress(ConnectionClosed),
        ):
            line.send(malformed(wheel, rng))
        wheel.step(0.001)
    assert answer_to(wheel) == 200
    assert wheel.simulation.outcome is None
    assert np.isfinite(wheel.simulation.state).all()
    out, err = capfd.readouterr()
    assert "Traceback" not in out + err


PAGE_OF_ANOTHER_ORIGIN = """<script>
let heard = 0, tried = 0;
const line = new WebSocket("ws://ADDRESS", "viser-vVERSION");
line.onopen = () => heard++; line.onmessage = () => heard++; line.onclose = () => tried++;
fetch("http://ADDRESS/").then(() => heard++).catch(() => {}).finally(() => tried++);
</script>"""


@pytest.mark.slow
@needs_browser
def test_a_page_of_another_origin_hears_nothing(tmp_path: Path, wheel: Live) -> None:
    text = PAGE_OF_ANOTHER_ORIGIN.replace("ADDRESS", wheel.address.removeprefix("http://"))
    (tmp_path / "page.html").write_text(text.replace("VERSION", viser.__version__))
    with browser(tmp_path) as driven:
        driven.open((tmp_path / "page.html").as_uri())
        driven.until("tried === 2")
        assert driven.value("heard") == 0


STUCK = """
import os, signal, sys, threading, time
from modelgen import cli
from modelgen.view import live_server
def run(live, until):
    threading.Thread(target=time.sleep, args=(1000,)).start()
    os.kill(os.getpid(), signal.{signal})
live_server.Live.run = run
live_server.Live.stop = lambda live: time.sleep(1000)
sys.argv = ["modelgen", "view", "{scene}", "--port", "18187"]
cli.main()
"""


@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM"])
def test_a_live_view_ends_although_an_interruption_left_a_lock_of_its_server_taken(
    number: str, tmp_path: Path
) -> None:
    code = STUCK.format(signal=number, scene=SCENES / "bouncing_ball.toml")
    ended = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120
    )
    assert (ended.returncode, ended.stderr) == (0, "")
