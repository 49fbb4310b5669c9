"""The page of a run holds the run, and loads nothing."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from modelgen import read, record_of, require, simulate
from modelgen.cli.commands import app
from modelgen.view.page import page_text
from tests.running import SCENES, scene_of

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
QUIET = (
    *("--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update"),
    *("--disable-sync", "--window-size=900,600", "--virtual-time-budget=3000", "--enable-logging=stderr"),
)


def page_of(name: str, until: float) -> tuple[str, dict[str, object]]:
    library = scene_of(name)
    trajectory = simulate(library, until=until)
    text = page_text(record_of(trajectory, library), require(read(SCENES / f"{name}.toml")))
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    return text, json.loads(found.group(1))


def numbers(text: str) -> np.ndarray:
    return np.frombuffer(b64decode(text), dtype="<f4")


@pytest.mark.parametrize("name", ["cube_toss", "double_pendulum", "glass_on_table"])
def test_a_page_holds_the_run(name: str) -> None:
    text, data = page_of(name, 0.2)
    assert not re.findall(r"https?://|src=|@import|fetch\(", text)
    trajectory = simulate(scene_of(name), until=0.2)
    assert np.allclose(numbers(data["t"]), trajectory.t, atol=1e-6)
    for index, body in enumerate(data["bodies"]):
        assert np.allclose(numbers(body["p"]).reshape(-1, 3), trajectory.p[:, index], atol=1e-5)
        corners = np.frombuffer(b64decode(body["triangles"]), dtype="<u4")
        assert not len(corners) or corners.max() < len(numbers(body["vertices"])) // 3
    assert [event["kind"] for event in data["events"]] == [event.kind for event in trajectory.events]
    assert {plot["title"] for plot in data["plots"]} >= {"energy", "speed"}


def test_the_command_writes_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = str(SCENES / "bouncing_ball.toml")
    answer = CliRunner().invoke(app, ["view", scene, "--until", "0.3", "--out", "ball.html"])
    assert answer.exit_code == 0, answer.output
    assert (tmp_path / "ball.html").stat().st_size > 10_000
    for wrong in ("ball.png", "nowhere/ball.html"):
        answer = CliRunner().invoke(app, ["view", scene, "--out", wrong])
        assert answer.exit_code == 2


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium")
def test_a_browser_draws_it_without_a_complaint(tmp_path: Path) -> None:
    from PIL import Image

    page = tmp_path / "page.html"
    page.write_text(page_of("cube_toss", 0.3)[0])
    pictures = []
    for time in (0.0, 0.25):
        shot = tmp_path / f"{time}.png"
        command = [str(BROWSER), *QUIET, f"--user-data-dir={tmp_path / 'profile'}", f"--screenshot={shot}"]
        answer = subprocess.run([*command, f"file://{page}#t={time}"], capture_output=True, text=True)
        assert "CONSOLE" not in answer.stderr, answer.stderr
        pictures.append(np.asarray(Image.open(shot).convert("RGB"), dtype=int)[60:450, 20:600])
    assert np.ptp(pictures[0], axis=(0, 1)).min() > 100
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 40).mean() > 0.01
