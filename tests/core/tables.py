"""The tables of coefficients of the core's integrators, read from their headers as exact numbers."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from typing import Any

from tests.core.compiling import CORE

NUMBER = re.compile(r"\(mg_real\)|L\b")


def tables(method: str) -> list[list[Any]]:
    """The arrays of the header of `method`, in the order of the file; rows of a matrix are lists."""
    (header,) = CORE.rglob(f"{method}_coefficients.h")
    text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.DOTALL)
    arrays = re.findall(r"static const \w+ \w+((?:\[\w+\])+) = (\{.*?\});", text, flags=re.DOTALL)
    return [_array(body) for _, body in arrays]


def _array(body: str) -> list[Any]:
    text = NUMBER.sub("", body).strip()[1:-1]
    rows = re.findall(r"\{[^{}]*\}", text)
    return [_array(row) for row in rows] or [_exact(item) for item in text.split(",") if item.strip()]


def _exact(text: str) -> Fraction:
    above, _, below = text.strip().partition("/")
    return Fraction(above.strip()) / Fraction(below.strip() or 1)


Tree = tuple["Tree", ...]  # a rooted tree: the trees that hang on its root, sorted


@cache
def trees(order: int) -> tuple[Tree, ...]:
    """All rooted trees of `order` vertices."""
    return tuple(_forests(order - 1, order - 1))


@cache
def _forests(vertices: int, most: int) -> tuple[Tree, ...]:
    """Sorted tuples of trees of at most `most` vertices each, of so many vertices in all."""
    if vertices == 0:
        return ((),)
    found = {
        tuple(sorted((*rest, tree)))
        for size in range(1, min(vertices, most) + 1)
        for tree in trees(size)
        for rest in _forests(vertices - size, size)
    }
    return tuple(sorted(found))


def order_of(tree: Tree) -> int:
    return 1 + sum(map(order_of, tree))


def density(tree: Tree) -> int:
    """gamma(t) of Butcher's theory: the order times the densities of the branches."""
    product = order_of(tree)
    for branch in tree:
        product *= density(branch)
    return product
