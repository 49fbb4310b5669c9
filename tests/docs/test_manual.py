"""`modelgen manual` prints every page; links lead somewhere; the page of keys is that of the schema."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path

import pytest
from click.testing import CliRunner
from rich.console import Console

from modelgen.cli import manual
from modelgen.cli.command_group import app
from modelgen.cli.manual import FOLDER, TOPICS, page
from modelgen.report.keys_page import keys_page, page_of, sections, sections_of
from modelgen.scene.joint_format import JOINT
from modelgen.scene.scene_format import SHAPE_KINDS
from tests.docs.pages import EXAMPLES, IMAGES, PAGES, anchors, blocks, links, text_of
from tests.running import NAMES


def test_every_page_is_a_topic() -> None:
    assert {path.stem for path in FOLDER.glob("*.md")} == set(TOPICS)


def test_topics_are_listed_with_a_line_each() -> None:
    result = CliRunner().invoke(app, ["manual"])
    assert result.exit_code == 0
    assert [line.split()[0] for line in result.stdout.splitlines()[: len(TOPICS)]] == list(TOPICS)


@pytest.mark.parametrize("topic", TOPICS)
def test_a_page_opens_with_a_title_and_one_sentence(topic: str) -> None:
    title, blank, summary, after = page(topic).split("\n")[:4]
    assert title.startswith("# ")
    assert (blank, after) == ("", "")
    assert summary.endswith(".")
    assert len(summary) <= 110


@pytest.mark.parametrize("topic", TOPICS)
def test_a_page_is_printed_as_it_is_through_a_pipe(topic: str) -> None:
    result = CliRunner().invoke(app, ["manual", topic])
    assert (result.exit_code, result.stdout) == (0, page(topic))


def test_a_page_is_rendered_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(manual, "Console", lambda: Console(force_terminal=True, width=100))
    result = CliRunner().invoke(app, ["manual", "joints"])
    assert result.exit_code == 0
    assert "# Joints" not in result.stdout
    assert "Joints" in result.stdout


@pytest.mark.parametrize(
    ("wrong", "nearest"),
    [("jonts", "joints"), ("friction", "contact_and_friction"), ("python", "python_api")],
)
def test_an_unknown_topic_names_the_nearest(wrong: str, nearest: str) -> None:
    result = CliRunner().invoke(app, ["manual", wrong])
    assert result.exit_code == 2
    assert f"did you mean {nearest!r}?" in result.stderr


def test_the_page_of_keys_is_that_of_the_schema() -> None:
    """Written anew by `modelgen manual keys > modelgen/manual/keys.md`."""
    assert text_of(FOLDER / "keys.md") == keys_page()


@pytest.mark.parametrize("names", [SHAPE_KINDS, JOINT.tables, ("[[contact]]", "[[spring]]", "[run]")])
def test_the_page_of_keys_has_every_table(names: Iterable[str]) -> None:
    assert not [name for name in names if f"`{name}`" not in keys_page()]


@pytest.mark.cases(20)
@pytest.mark.parametrize("key", [*SHAPE_KINDS, *JOINT.tables, "run", "contact", "body", "static"])
def test_every_table_kind_and_key_has_a_page_of_its_own(key: str) -> None:
    result = CliRunner().invoke(app, ["schema", key])
    assert result.exit_code == 0
    assert result.stdout == page_of(key) + ("" if page_of(key).endswith("\n") else "\n")
    assert key in result.stdout
    listed = json.loads(CliRunner().invoke(app, ["schema", key, "--json"]).stdout)
    assert listed
    assert {row["key"] for section in listed for row in section["rows"]} <= {
        row.key for section in sections() for row in section.rows
    }


def test_the_page_of_a_key_has_its_row_in_every_table_that_has_the_key() -> None:
    rows = [row for section in sections_of("restitution") for row in section.rows]
    everywhere = [row for section in sections() for row in section.rows]
    assert rows == [row for row in everywhere if "restitution" in row.key.split(".")]
    assert len(rows) > 2


@pytest.mark.parametrize(
    ("wrong", "nearest"), [("frictoin", "friction"), ("tourus", "torus"), ("mu", "friction")]
)
def test_an_unknown_key_names_the_nearest(wrong: str, nearest: str) -> None:
    result = CliRunner().invoke(app, ["schema", wrong])
    assert result.exit_code == 2
    assert f"did you mean {nearest!r}?" in result.stderr


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_links_lead_somewhere(path: Path) -> None:
    for link in links(path):
        if "://" in link:
            continue
        name, _, anchor = link.partition("#")
        target = (path.parent / name).resolve() if name else path
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("topic", EXAMPLES)
def test_the_script_of_a_page_is_printed(topic: str) -> None:
    result = CliRunner().invoke(app, ["manual", topic, "--script"])
    assert result.exit_code == 0
    assert result.stdout == "\n".join(blocks(FOLDER / f"{topic}.md", "python"))


def test_the_gallery_shows_each_shipped_scene_once() -> None:
    text = text_of(FOLDER / "gallery.md")
    shown = re.findall(r"!\[[^\]]+\]\(images/scenes/(\w+)\.png\)", text)
    assert sorted(shown) == list(NAMES)
    assert [name for name in NAMES if text.count(f"](../../scenes/{name}.toml)") != 1] == []


def test_pictures_are_small() -> None:
    pictures = [path for path in IMAGES.rglob("*") if path.is_file()]
    shown = "".join(map(text_of, PAGES))
    assert pictures
    assert all(f"images/{path.relative_to(IMAGES).as_posix()}" in shown for path in pictures)
    assert max(path.stat().st_size for path in pictures) < 60_000
    assert sum(path.stat().st_size for path in pictures) < 1_500_000
