"""The elements of an XML file, nested as deep as robots are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

DEEPEST = 200  # elements in each other; MuJoCo and most programs that go through them call themselves


def xml_root(path: Path) -> ElementTree.Element:
    """The root of an XML file. Raises ValueError, with the reason, for another file."""
    depth, root = 0, None
    for event, element in _events(path):
        depth += 1 if event == "start" else -1
        root = element if root is None else root
        if depth > DEEPEST:
            raise ValueError(f"more than {DEEPEST} elements in each other")
    assert root is not None
    return root


def first_element(path: Path) -> str:
    """The name of the root of an XML file; empty where it has none."""
    try:
        return next(_events(path))[1].tag
    except (ValueError, StopIteration):
        return ""


def _events(path: Path) -> Iterator[tuple[str, ElementTree.Element]]:
    try:
        yield from ElementTree.iterparse(path, events=("start", "end"))
    except (ElementTree.ParseError, LookupError) as error:  # the second: encodings
        raise ValueError(str(error)) from None
