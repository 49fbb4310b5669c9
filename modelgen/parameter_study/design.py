"""Which values the runs of a sweep have: a grid of values, or points drawn from ranges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np

from modelgen.errors import ModelgenError, SceneError
from modelgen.runtime.arguments import check_name, check_whole, numbers_in, values_by_name
from modelgen.runtime.trajectory import Array
from modelgen.scene.scalar_types import NUMBER
from modelgen.scene.source_location import Place

DESIGNS = ("grid", "sobol", "latin", "random")
MOST = 10_000_000  # runs of a sweep
LOG = "log"
FORM = "NAME=a:b:n, NAME=a:b (with a number of samples), or NAME=a,b,c"


@dataclass(frozen=True, slots=True)
class Variation:
    """The values that a number takes: those listed, or any in a range."""

    name: str
    text: str  # as it was given
    low: float
    high: float
    values: tuple[float, ...] = ()  # none: any from low to high
    is_log: bool = False  # whether a range is even in the logarithm

    def at(self, shares: Array) -> Array:
        """The values (n,) at shares (n,) from 0 to 1 of the way."""
        if self.values:
            index = np.minimum(shares * len(self.values), len(self.values) - 1).astype(int)
            return np.asarray(np.take(self.values, index))
        return _between(self.low, self.high, shares, self.is_log)


def variations_of(vary: Mapping[str, str | Sequence[float]]) -> tuple[Variation, ...]:
    """The variations of names: texts such as "0:1:11", "0:1", "1e3:1e6:4:log" and "0.1,0.2", or values.

    Raises ModelgenError for a text that is none of them, or where nothing varies.
    """
    if not isinstance(vary, Mapping) or not vary:
        found = "nothing varies" if isinstance(vary, Mapping) else f"a {type(vary).__name__}"
        raise ModelgenError("vary", found, f"at least one {FORM}", "")
    return tuple(_variation(name, values) for name, values in values_by_name("vary", vary).items())


def design_points(
    variations: Sequence[Variation], samples: int | None, design: str | None, seed: int
) -> tuple[str, Array]:
    """The design, and the values (n, number of variations) of its runs.

    Args:
        samples: number of runs of a design that draws them; None: a grid of all combinations, of which the
            last number varies fastest.
        design: of DESIGNS; sobol when None and `samples` is given.
        seed: of the draws; equal seeds draw equal values.

    Raises ModelgenError where these do not go together.
    """
    kind = ("grid" if samples is None else "sobol") if design is None else design
    check_name("design", kind, DESIGNS)
    if kind == "grid":
        _check_grid(variations, samples)
        return kind, np.array(list(product(*(each.values for each in variations))), dtype=float)
    count = _count(kind, samples)
    shares = _shares(kind, count, len(variations), seed)
    return kind, np.stack([each.at(shares[:, k]) for k, each in enumerate(variations)], axis=1)


def _variation(name: str, given: str | Sequence[float]) -> Variation:
    text = given if isinstance(given, str) else _listed(name, given)
    where = f"vary {name}={text}"
    parts = [part.strip() for part in text.split(":")]
    is_log = len(parts) in (3, 4) and parts[-1] == LOG
    numbers = parts[:-1] if is_log else parts
    if len(numbers) == 1:
        values = tuple(_number(part, where) for part in text.split(","))
        if len(set(values)) < len(values):
            raise ModelgenError(where, "a value twice", "", "leave one out")
        return Variation(name, text, min(values), max(values), values)
    if len(numbers) not in (2, 3):
        raise ModelgenError(where, "no values", FORM)
    low, high = _number(numbers[0], where), _number(numbers[1], where)
    if not low < high or (is_log and low <= 0):
        least = "0 < a < b" if is_log else "a < b"
        raise ModelgenError(where, f"from {low:g} to {high:g}", f"a:b needs {least}", "exchange them")
    if len(numbers) == 2:
        return Variation(name, text, low, high, (), is_log)
    count = _whole(numbers[2])
    if not 2 <= count <= MOST:
        raise ModelgenError(where, f"{numbers[2]!r} values", "a whole number from 2 on", "write NAME=a:b:5")
    values = tuple(_between(low, high, np.linspace(0.0, 1.0, count), is_log).tolist())
    return Variation(name, text, low, high, values, is_log)


def _listed(name: str, given: object) -> str:
    """Values as text."""
    values = numbers_in(f"vary {name}", given, FORM)
    if values.ndim != 1 or not len(values):
        raise ModelgenError(f"vary {name}", f"an array of shape {values.shape}", FORM)
    return ",".join(map(repr, values.tolist()))


def _between(low: float, high: float, shares: Array, is_log: bool) -> Array:
    found = low * (high / low) ** shares if is_log else low + (high - low) * shares
    return np.clip(found, low, high)


def _number(text: str, where: str) -> float:
    try:
        return NUMBER.read(float(text) if _is_plain(text) else text, Place(where))
    except SceneError as error:
        raise ModelgenError(where, error.found, error.allowed or "numbers", error.remedy or FORM) from None


def _is_plain(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _whole(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() else 0


def _check_grid(variations: Sequence[Variation], samples: int | None) -> None:
    if samples is not None:
        raise ModelgenError(
            "design", f"a grid, with {samples} samples", "", "leave samples out, or choose another design"
        )
    for each in variations:
        if not each.values:
            remedy = f"write {each.name}={each.text}:5, or give a number of samples"
            raise ModelgenError(f"vary {each.name}={each.text}", "a range", "a grid needs values", remedy)
    _check_size(prod(len(each.values) for each in variations))


def _count(kind: str, samples: int | None) -> int:
    if samples is None:
        found = "no number of samples"
        raise ModelgenError("design", f"{kind}, {found}", "it draws so many runs", "give the samples")
    count = check_whole("samples", samples, "give the number of runs")
    _check_size(count)
    return count


def _check_size(runs: int) -> None:
    if runs > MOST:
        raise ModelgenError("vary", f"{runs} runs", f"at most {MOST} are allowed", "take fewer values")


def _shares(kind: str, count: int, size: int, seed: int) -> Array:
    """(count, size) numbers from 0 to 1."""
    if kind == "random":
        return np.random.default_rng(seed).random((count, size))
    from scipy.stats import qmc

    if kind == "latin":
        return np.asarray(qmc.LatinHypercube(size, seed=seed).random(count))
    whole = (count - 1).bit_length()  # the balance of the sequence is that of the next power of two
    return np.asarray(qmc.Sobol(size, scramble=True, seed=seed).random_base2(whole)[:count])
