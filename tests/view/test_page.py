"""The page of a run holds the run, and loads nothing."""

from __future__ import annotations

import json
import re
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from modelgen import load, read, record_of, save, simulate
from modelgen.cli.command_group import app
from modelgen.errors import ModelgenError
from modelgen.view.page import page_text
from tests.running import SCENES, scene_of
from tests.view.browser import browser, needs_browser


def page_of(name: str, until: float) -> tuple[str, dict[str, object]]:
    library = scene_of(name)
    trajectory = simulate(library, until=until)
    text = page_text(record_of(trajectory, library, read(SCENES / f"{name}.toml")))
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
        packed = body["triangles"]
        corners = np.frombuffer(b64decode(packed["values"]), dtype=f"<u{packed['bytes']}")
        assert not len(corners) or corners.max() < len(numbers(body["vertices"])) // 3
        assert len(b64decode(body["normals"])) == len(numbers(body["vertices"]))
    for contact in data["contacts"]:
        k = trajectory.contact_names.index(contact["name"])
        assert np.allclose(numbers(contact["force"]), trajectory.force[:, k], rtol=1e-6)
    assert [event["kind"] for event in data["events"]] == [event.kind for event in trajectory.events]
    assert {plot["title"] for plot in data["plots"]} >= {"energy", "speed", "position"}


def test_a_file_of_a_run_gives_the_page_of_the_run(tmp_path: Path) -> None:
    library = scene_of("balancing_wheel")
    trajectory = simulate(library, until=0.1)
    record = record_of(trajectory, library, read(SCENES / "balancing_wheel.toml"))
    save(record, tmp_path / "run.npz")
    assert page_text(load(tmp_path / "run.npz")) == page_text(record)
    with pytest.raises(ModelgenError, match="does not hold its scene"):
        page_text(record_of(simulate(scene_of("cube_toss"), until=0.1), scene_of("cube_toss")))


def test_commands_write_pages_or_say_what_is_wrong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = str(SCENES / "bouncing_ball.toml")

    def called(*words: str) -> int:
        return CliRunner().invoke(app, list(words)).exit_code

    assert called("simulate", scene, "--until", "0.3", "--out", "ball.npz", "--json") == 0
    assert called("view", "ball.npz", "--out", "ball.html", "--plots", "position,energy") == 0
    assert '"title":"position","unit":"m","open":true' in Path("ball.html").read_text()
    assert called("view", scene, "--until", "0.3", "--out", "scene.html", "--json") == 0
    assert called("report", "ball.npz", "--out", "report.html", "--frames", "2") == 0
    for wrong in (
        *(("view", scene, "--out", "ball.png"), ("view", scene, "--out", "nowhere/ball.html")),
        ("view", "ball.npz", "--out", "ball.html", "--plots", "gaps"),
        ("view", "ball.npz", "--out", "ball.html", "--until", "2"),
        *(("view", "none.npz", "--out", "ball.html"), ("view", "ball.npz"), ("view", scene, "--port", "0")),
        *(("report", "none.toml", "--out", "ball.html"), ("report", "ball.npz", "--out", "ball.txt")),
    ):
        assert called(*wrong) == 2, wrong


@pytest.mark.slow
@needs_browser
def test_a_browser_draws_it_without_a_complaint(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text(page_of("cube_toss", 0.3)[0])
    pictures = []
    with browser(tmp_path) as driven:
        for time in (0.0, 0.25):
            driven.open("about:blank")
            driven.open(f"file://{page}#t={time}")
            pictures.append(driven.shot()[90:640, 20:880])
        driven.value("document.getElementById('after').click()")
        driven.settle()
        later = float(driven.value("document.getElementById('slider').value"))
        driven.value("document.getElementById('play').click()")
        driven.until(f"+document.getElementById('slider').value > {later}")
        assert not driven.serious
        assert {request.split(":")[0] for request in driven.requests} <= {"file", "about"}
    events = [event.t for event in simulate(scene_of("cube_toss"), until=0.3).events]
    assert later == pytest.approx(min([t for t in events if t > 0.25] or [0.3]), abs=1e-6)
    assert np.ptp(pictures[0], axis=(0, 1)).min() > 100  # more than the background
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 40).mean() > 0.01


# whether name and choices are apart; px: end of the header, highest and lowest point of the bodies, the key
EXTENT = """(() => {
  const width = canvas.clientWidth, height = canvas.clientHeight, rows = [];
  for (const t of times) {
    const place = locate(t), seen = cameraMatrix(eyeOf(camera.centre), camera.centre, width, height);
    for (const body of data.bodies.filter(each => each.bounded)) {
      const { R, p } = poseOf(body, place), own = [...body.vertices, ...body.lines];
      for (let i = 0; i < own.length; i += 3) {
        const [x, y, z] = add(p, turned(R, own.slice(i, i + 3)));
        const [up, away] = [1, 3].map(k => seen[k]*x + seen[k+4]*y + seen[k+8]*z + seen[k+12]);
        rows.push(height / 2 * (1 - up / away));
      }
    }
  }
  const box = id => document.getElementById(id).getBoundingClientRect();
  const apart = box("title").right < box("shown").left || box("title").bottom <= box("shown").top;
  return [apart, box("head").bottom, rows.reduce((a, b) => Math.min(a, b)),
          rows.reduce((a, b) => Math.max(a, b)), box("key").height ? box("key").top : height];
})()"""


@pytest.mark.slow
@needs_browser
@pytest.mark.parametrize("size", [(1280, 800), (900, 500), (480, 900)])
@pytest.mark.parametrize("name", ["linked_rings", "double_pendulum", "bouncing_ellipsoid"])
def test_header_and_key_cover_no_body(name: str, size: tuple[int, int], tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text(page_of(name, 0.5)[0])
    with browser(tmp_path) as driven:
        driven.open(f"file://{page}#t=0", *size)
        apart, header, highest, lowest, key = driven.value(EXTENT)
    assert apart
    assert header < highest < lowest < key


PRESSED = """(() => { const controls = document.querySelectorAll("button, input, select, summary");
controls[NUMBER].focus();
return [document.activeElement.tagName, document.activeElement.type || ""]; })()"""
STATE = """(() => { const one = document.activeElement, details = one.closest("details");
return [playing, now, one.checked || false, one.value || "", details ? details.open : false]; })()"""


@pytest.mark.slow
@needs_browser
def test_keys_belong_to_the_control_that_has_the_focus(tmp_path: Path) -> None:
    """Space toggles a box and presses a button, arrows move a slider and a choice; where nothing or the
    picture has the focus they play and go to events."""
    page = tmp_path / "page.html"
    page.write_text(page_of("cube_toss", 0.5)[0])
    with browser(tmp_path) as driven:
        driven.open(f"file://{page}#t=0.1")
        for focus in ("document.activeElement.blur()", "canvas.focus()"):
            driven.value(focus)
            playing = driven.value("playing")
            driven.press(" ", 32)
            assert driven.value("playing") is not playing
            driven.value("go(0)")
            driven.press("ArrowRight", 39)
            assert driven.value("now") == pytest.approx(driven.value("data.events.find(e => e.t > 0).t"))
        driven.value("document.querySelector('details').open = true")
        count = driven.value("document.querySelectorAll('button, input, select, summary').length")
        tried = set()
        for number in range(count):
            driven.value("go(0.1)")
            driven.settle()
            kind = tuple(driven.value(PRESSED.replace("NUMBER", str(number))))
            tried.add(kind)
            before = driven.value(STATE)
            driven.press(*(("ArrowRight", 39) if kind[1] in ("range", "select-one") else (" ", 32)))
            driven.settle()
            after = driven.value(STATE)
            if kind == ("INPUT", "checkbox"):
                assert (after[2], after[:2]) == (not before[2], before[:2])
            elif kind == ("INPUT", "range"):
                assert 0 < after[1] - before[1] < 0.01
            elif kind[0] == "SELECT":
                assert (after[3] != before[3], after[:2]) == (True, before[:2])
            elif kind[0] == "SUMMARY":
                assert (after[4], after[:2]) == (not before[4], before[:2])
        assert {("INPUT", "checkbox"), ("INPUT", "range"), ("SELECT", "select-one"), ("SUMMARY", "")} <= tried
