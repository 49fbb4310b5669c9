"""A run that plays in the browser while it is computed (extra `view`), with sliders for its inputs and
parameters."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from modelgen.assembly import require
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError, install
from modelgen.model import Model
from modelgen.report.displayed_bodies import stage_at_start
from modelgen.report.printed_rounding import NOISE, vector_text
from modelgen.report.recorded_scene import kept_scene, read_again
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import input_range
from modelgen.runtime.contacts import columns_now
from modelgen.runtime.stepped_simulation import Simulation, start
from modelgen.view.arrows import arrows_of
from modelgen.view.slider_range import slider_range

try:
    from modelgen.view.guarded_server import serve_page
except ImportError:
    raise ModelgenError("view", "no package 'viser'", "", install("view")) from None

Array = np.ndarray[Any, Any]

FRAME = 1 / 30  # s, time on the clock between two pictures
FACTORS = {f"{each:g}": each for each in (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)}  # by the text of the choice
STEPS = 200  # of a slider
TOLERANCE = 1e-2  # of the meshes, as a part of the size of a shape
AWAY = 1e4  # sizes of the picture, where marks go that are not shown
GREY, EDGE = (0.80, 0.82, 0.85), (31, 41, 51)
INKS = {"normal": (194, 43, 38), "friction": (242, 153, 26), "pressure": (122, 46, 133)}


class Live:
    """A run in the browser. What the controls say is read before each picture, so that they can be set from
    Python too: `live.inputs["torque"].value = 0.5`.

    Attributes:
        simulation: the run, as `start` returned it; another one after a reset.
        running, speed, follow, reset: controls of the page; whether time goes on, simulated time per time
            on the clock, whether the picture moves with the bodies, and the button that starts anew.
        inputs, parameters: sliders by name. Another value of a parameter starts the run anew.
    """

    def __init__(
        self,
        library: Library,
        model: Model,
        *,
        inputs: Mapping[str, float] | None = None,
        parameters: Mapping[str, float] | None = None,
        accuracy: Accuracy | str | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
    ) -> None:
        """Start the run and the server of its page.

        Args:
            library: what `build` returned.
            model: what `require` made of its scene.
            inputs, parameters, accuracy: as of `start`.
            host, port: where the page is served; the next free port if that is taken.

        Raises:
            ModelgenError: the start, an input or a parameter is refused.
        """
        self._library, self._accuracy = library, accuracy
        self._parameters = dict(parameters or {})
        self.simulation = self._start(dict(inputs or {}))
        instance = self.simulation.session.instance
        self._stage = stage_at_start(columns_now(self.simulation.session), model, TOLERANCE)
        self._server = serve_page(host, port, instance["name"])
        self._host = host
        gui = self._server.gui
        self.running: Any = gui.add_checkbox("run", True)
        self.speed = gui.add_dropdown("speed", list(FACTORS), initial_value="1")
        self.follow = gui.add_checkbox("follow", False)
        self.reset = gui.add_button("reset")
        self._asked_reset = False
        self.reset.on_click(lambda _: self.ask_reset())
        self._ends: dict[str, tuple[float, float]] = {}
        self.inputs = {each["name"]: self._input_slider(each) for each in instance["inputs"]}
        self.parameters = {
            each["name"]: self._parameter_slider(each) for each in instance.get("parameters", ())
        }
        self._told = gui.add_markdown("")
        self._message, self._largest = "", 0.0
        self._centre: Array | None = None
        self._show_bodies()
        self.draw()

    @property
    def address(self) -> str:
        """Where the page is."""
        return f"http://{self._host}:{self._server.get_port()}"

    def run(self, until: float | None = None) -> None:
        """Play until the caller is interrupted; the run stops at the time `until`, s."""
        while True:
            before = time.monotonic()
            if until is not None and self.simulation.t >= until:
                self.running.value = False
            self.step(FRAME)
            time.sleep(max(FRAME - (time.monotonic() - before), 0.0))

    def step(self, clock: float) -> None:
        """Obey the controls, go on by a time on the clock, s, if the run is to go on, and draw."""
        self._obey()
        simulation = self.simulation
        if self.running.value and simulation.outcome is None:
            span = clock * FACTORS.get(self.speed.value, 1.0)
            self._steer(span)
            simulation.step(until=simulation.t + span)
            self._message = _ending(simulation) or self._message
        self.draw()

    def stop(self) -> None:
        """End the server."""
        self._server.stop()

    def _start(self, inputs: Mapping[str, float]) -> Simulation:
        given = {"inputs": inputs, "parameters": self._parameters, "accuracy": self._accuracy}
        return start(self._library, **given)  # type: ignore[arg-type]

    def ask_reset(self) -> None:
        """Start anew before the next picture."""
        self._asked_reset = True

    def place(self, body: str) -> Array:
        """(3,) m, where the centre of mass of a body is shown."""
        names = [actor.name for actor in self._stage.actors]
        return np.array(self._frames[names.index(body)].position)

    def _obey(self) -> None:
        """Start anew where that was asked for, or a parameter has another value. A value that is refused is
        told, and its slider goes back."""
        own = {each["name"]: each["value"] for each in self._library.manifest.instance.get("parameters", ())}
        present = own | self._parameters
        wanted = {name: self._value(name, slider, present[name]) for name, slider in self.parameters.items()}
        changed = {name: value for name, value in wanted.items() if value != present[name]}
        if not changed and not self._asked_reset:
            return
        self._asked_reset, before = False, self._parameters
        self._parameters = {**before, **changed}
        try:
            self.simulation = self._start(self._wanted_inputs())
            self._message = ""
        except ModelgenError as error:
            self._parameters, self._message = before, str(error)
            for name in changed:
                self.parameters[name].value = present[name]
            return
        if changed:
            model = require(read_again(kept_scene(None, self._library), own | self._parameters, "view"))
            self._stage = stage_at_start(columns_now(self.simulation.session), model, TOLERANCE)
            self._show_bodies()

    def _steer(self, span: float) -> None:
        """Bring inputs to what the sliders say: at once, or, where they are continuous, within a step."""
        inputs, of_sliders = self.simulation.inputs, self._wanted_inputs()
        for kind in self.simulation.session.instance["inputs"]:
            name = kind["name"]
            value, wanted = inputs[name], of_sliders[name]
            if kind["hold"] == "linear":
                inputs.ramp(name, (wanted - value) / span)
            elif value != wanted:
                inputs[name] = wanted

    def _wanted_inputs(self) -> dict[str, float]:
        present = self.simulation.inputs
        return {name: self._value(name, slider, present[name]) for name, slider in self.inputs.items()}

    def _value(self, name: str, slider: Any, present: float) -> float:
        """The number of a slider; the present one where a client has sent none within its ends."""
        low, high = self._ends[name]
        value = float(slider.value)
        return value if low <= value <= high else present

    def _input_slider(self, kind: Mapping[str, Any]) -> Any:
        low, high = input_range(kind)
        return self._slider(kind, self.simulation.inputs[kind["name"]], low, high)

    def _parameter_slider(self, kind: Mapping[str, Any]) -> Any:
        low, high = input_range(kind)
        return self._slider(kind, self._parameters.get(kind["name"], kind["value"]), low, high)

    def _slider(self, kind: Mapping[str, Any], value: float, low: float, high: float) -> Any:
        """A slider over the range; where an end is missing it is a way off that suits the value."""
        low, high = self._ends[kind["name"]] = slider_range(low, high, value)
        label = f"{kind['name']} [{kind['unit']}]" if kind["unit"] else kind["name"]
        return self._server.gui.add_slider(label, low, high, (high - low) / STEPS, value)

    def _show_bodies(self) -> None:
        scene, stage = self._server.scene, self._stage
        scene.set_up_direction("+z")
        self._frames = []
        for index, (actor, shade) in enumerate(zip(stage.actors, stage.colours(GREY), strict=True)):
            name, mesh = f"/bodies/{index}", actor.mesh
            self._frames.append(scene.add_frame(name, show_axes=False))
            red, green, blue = (round(255 * part) for part in shade)
            colour = (red, green, blue)
            if len(mesh.triangles):
                side: Literal["double", "front"] = "double" if actor.two_sided else "front"
                scene.add_mesh_simple(f"{name}/faces", mesh.vertices, mesh.triangles, color=colour, side=side)
            if len(mesh.lines):
                thick, ink = (0.004, EDGE) if len(mesh.triangles) else (0.02, colour)
                scene.add_line_segments(f"{name}/lines", mesh.lines, ink, thickness=thick * stage.size)
        away = np.full((1, 2, 3), AWAY * stage.size)
        self._arrows = {
            kind: scene.add_line_segments(f"/{kind}", away, ink, thickness=0.02 * stage.size)
            for kind, ink in INKS.items()
        }
        camera = self._server.initial_camera
        camera.position = stage.centre + stage.size * np.array([1.2, -2.1, 1.0])
        camera.look_at = stage.centre

    def draw(self) -> None:
        """Show the present state."""
        columns = columns_now(self.simulation.session)
        self._look(columns)
        for index, frame in enumerate(self._frames):
            quaternion = columns["quaternion"][0, index]
            frame.position = columns["p"][0, index]
            if np.isfinite(quaternion).all():
                frame.wxyz = quaternion
        moving = [actor.moves for actor in self._stage.actors]
        for kind, arrows in arrows_of(columns, self.simulation.session.instance, moving).items():
            self._arrows[kind].points = self._segments(*arrows)
        self._told.content = self._text()

    def _look(self, columns: Mapping[str, Array]) -> None:
        """Move the cameras with the bodies that move, if asked to."""
        seen = self._stage.followed
        centre = columns["p"][0, seen].mean(axis=0) if seen else self._stage.centre
        if self.follow.value and self._centre is not None and np.linalg.norm(centre - self._centre) > 0:
            for client in self._server.get_clients().values():
                client.camera.position = client.camera.position + (
                    centre - self._centre
                )  # and where it looks
        self._centre = centre

    def _text(self) -> str:
        """Time, sensors, and what there is to say."""
        simulation = self.simulation
        lines = [f"t = {simulation.t:.4f} s"]
        for name, value in simulation.sensors.items():
            components = np.atleast_1d(value)
            lines.append(f"{name}: {vector_text(components, NOISE * float(np.abs(components).max()))}")
        return "  \n".join([*lines, *([self._message] if self._message else [])])

    def _segments(self, points: Array, forces: Array) -> Array:
        """Forces as segments (n, 2, 3), the longest for the largest since the start; n is always the same,
        and those of no force are far away."""
        size, away = self._stage.size, np.full(3, AWAY * self._stage.size)
        sizes = np.linalg.norm(np.nan_to_num(forces), axis=1)
        there = np.isfinite(points).all(axis=1) & (sizes > 0)
        self._largest = max(self._largest, float(sizes[there].max(initial=0.0)))
        ends = np.stack([points, points + 0.5 * size / (self._largest or 1.0) * forces], axis=1)
        segments: Array = np.where(there[:, None, None], ends, away)
        return segments if len(segments) else np.broadcast_to(away, (1, 2, 3))


def _ending(simulation: Simulation) -> str:
    """How a run ended early, and the advice; empty as long as it goes on."""
    outcome = simulation.outcome
    return "" if outcome is None else f"{outcome.name.lower()}: {outcome.value}"
