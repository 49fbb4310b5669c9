"""The scene that is measured: what its knobs can do, and its libraries, built once each."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from modelgen.assembly import require
from modelgen.benchmark.knobs import KNOBS, Facts, Settings, Space
from modelgen.benchmark.sampled_motion import Bodies, uninterrupted
from modelgen.codegen.build import build
from modelgen.codegen.emit import emit
from modelgen.codegen.library import Library
from modelgen.codegen.manifest_repeated_pairs import without_repeats
from modelgen.contact.form_table import regular_forms
from modelgen.derivation import derive
from modelgen.model import Model
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.simulate import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import RunSettings, Scene

BUILD = {"form": "auto", "real": "double", "level": "O2"}  # knobs of the build, and what a scene has unasked

FORMAT = 3  # of what is remembered; another one makes the old unknown


@dataclass(frozen=True, slots=True)
class Built:
    """A library, and how long the compiler took; None if it was there already."""

    library: Library
    compile_s: float | None


@dataclass(frozen=True)
class Subject:
    """A scene with the span that is measured."""

    scene: Scene
    until: float  # s
    samples: int
    root: Path  # what holds generated folders
    _built: dict[tuple[str, ...], Built] = field(default_factory=dict)

    def space(self, names: tuple[str, ...] | None = None) -> Space:
        """The knobs that matter here, or those of the given names alone."""
        model = self._model(None)
        facts = Facts(
            until=self.until,
            time=self.characteristic_time,
            forms=_forms(self, model),
            contacts=bool(model.contacts),
            joints=bool(model.joints),
            friction=any(pair.friction for pair in self.scene.contacts),
        )
        return Space(KNOBS, facts, names, self._own(facts))

    def _own(self, facts: Facts) -> dict[str, Any]:
        """Knobs that the scene sets; a form that gives the same equations as `auto` is not one."""
        said = {knob.name: getattr(self.scene.run, knob.name) for knob in KNOBS}
        own = {name: value for name, value in said.items() if value is not None}
        if own.get("form") not in facts.forms:
            own.pop("form", None)
        return own

    def _model(self, form: str | None) -> Model:
        return require(self.with_form(form))

    def with_form(self, form: str | None) -> Scene:
        """The scene as it stands, its free contacts in one form."""
        return replace(self.scene, run=replace(self.scene.run, form=None if form == "auto" else form))

    def built(self, settings: Settings) -> Built:
        """The library of some settings, in a folder of its own where the scene would not build it unasked."""
        form, real, level = (str(settings.get(name, value)) for name, value in BUILD.items())
        if (form, real, level) not in self._built:
            own = [part for part, plain in ((form, "auto"), (level, "O2")) if part != plain]
            folder = self.root / ".".join([self.scene.name, *own])
            package = emit(derive(require(self.with_form(form))))
            files = set(folder.resolve().glob("lib*.so"))
            begun = time.perf_counter()
            library = build(package, real=real, folder=folder, level=level)
            spent = time.perf_counter() - begun
            self._built[form, real, level] = Built(
                library, None if library.path.resolve() in files else spent
            )
        return self._built[form, real, level]

    def accuracy(self, settings: Settings) -> Accuracy:
        run = applied(self.scene.run, settings).said()
        scales = {"time": self.characteristic_time}
        pairs = [{"friction": [asdict(each) for each in pair.friction]} for pair in self._model(None).pairs]
        instance = {"run": run, "source": self.scene.source, "scales": scales, "pairs": pairs}
        return accuracy_of(instance, None, {})

    @cached_property
    def characteristic_time(self) -> float:
        """s."""
        return self._model(None).scales.time

    def run(self, library: Library, accuracy: Accuracy) -> Trajectory:
        """A run over the span; an interruption stays one."""
        path = simulate(library, until=self.until, samples=self.samples, accuracy=accuracy, estimate=False)
        return uninterrupted(path)

    def key(self, library: Library, what: Mapping[str, Any]) -> str:
        """SHA-256 (hex) of what decides a measurement: the scene, the library, the span, and `what`."""
        whole = without_repeats(library.manifest.instance)
        instance = {k: v for k, v in whole.items() if k not in ("run", "source")}
        span = [self.until, self.samples, self.scene.run.accuracy]
        parts = [FORMAT, instance, library.record.hash, span, what]
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()

    def bodies(self, library: Library) -> Bodies:
        return Bodies.of(library.manifest.instance)


def applied(run: RunSettings, settings: Settings) -> RunSettings:
    """The settings of a scene's run with measured ones in the place of all that it chose itself."""
    cleared: dict[str, Any] = {knob.name: None for knob in KNOBS}
    plain = {name: value for name, value in settings.items() if BUILD.get(name) != value}
    return replace(run, **cleared | plain)


def _forms(subject: Subject, model: Model) -> dict[str, int]:
    """`auto`, and each form that gives other equations, the scene's own first; with its entries of eta."""
    own = subject.scene.run.form
    kinds = [[own] if own else [], *(regular_forms(kind.o, kind.f) for kind in model.contact_kinds)]
    found, known = {"auto": model.n_eta}, [model.contact_kinds]
    for form in dict.fromkeys(form for forms in kinds for form in forms):
        other = require(subject.with_form(form))
        if other.contact_kinds not in known:
            known.append(other.contact_kinds)
            found[form] = other.n_eta
    return found
