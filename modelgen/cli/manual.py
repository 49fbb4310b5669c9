"""The manual: its topics, the text of a page, and how a page is printed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import click
from rich.console import Console

from modelgen.cli.command import Argument, Option
from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest

FOLDER = Path(__file__).parent.parent / "manual"
TOPICS = (
    *("first_steps", "gallery", "scenes", "keys", "shapes", "joints", "contact_and_friction", "impacts"),
    *(
        "planar_contact",
        "accuracy",
        "trust",
        "time_stepping",
        "solvers",
        "forms_and_formulas",
        "python_api",
        "driven_runs",
    ),
    *("view", "sensitivities", "fit", "sweep", "casadi", "optimisation", "c", "export", "import"),
    *("example_cam", "example_rattleback", "example_grip", "example_throw", "example_sliding_ball"),
    *("scenes_of_others", "command_line", "limits", "troubleshooting"),
    *("development", "design_notes"),
    *("measurements", "glossary", "changelog"),
)

Topic = Annotated[str | None, Argument(metavar="TOPIC", help="a page; without it the list of pages")]


Script = Annotated[bool, Option("--script", help="the Python code of the page alone")]


def manual(topic: Topic = None, script: Script = False) -> None:
    """Print a page of the manual, or the list of its topics."""
    if topic is None:
        width = max(map(len, TOPICS))
        for name in TOPICS:
            click.echo(f"{name:{width}}  {summary_of(page(name))}")
        click.echo("\nmodelgen manual TOPIC prints a page.")
        return
    if script:
        click.echo(script_of(page(topic)), nl=False)
    else:
        print_page(page(topic))


def script_of(text: str) -> str:
    """The Python blocks of a page, one after another."""
    blocks: list[str] = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return "\n".join(blocks)


def print_page(text: str) -> None:
    """Print a page of Markdown: laid out on a terminal, as it is elsewhere."""
    console = Console()
    if console.is_terminal:
        from rich.markdown import Markdown

        console.print(Markdown(text), soft_wrap=False)
    else:
        click.echo(text, nl=False)


def page(topic: str) -> str:
    """The Markdown text of a topic. Raises ModelgenError if there is no such topic."""
    if topic not in TOPICS:
        allowed = "the topics are " + ", ".join(TOPICS)
        raise ModelgenError(f"topic {topic!r}", "the manual has no such page", allowed, _meant(topic))
    if topic == "keys":
        from modelgen.report.keys_page import keys_page

        return keys_page()
    return (FOLDER / f"{topic}.md").read_text(encoding="utf-8")


def _meant(topic: str) -> str:
    """`did you mean 'x'?` for the topic nearest to a text, or for one that has the text as a word."""
    having = [name for name in TOPICS if topic.lower() in name.split("_")]
    return f"did you mean {having[0]!r}?" if having else nearest(topic, TOPICS)


def summary_of(text: str) -> str:
    """The line below the title of a page."""
    return text.split("\n", 3)[2]
