"""The command line: the verbs of the street, and what they print.

Exit codes: 0 done; 1 the run ended early (what it computed is written); 2 bad input (nothing is written);
130 interrupted (what was computed is written).
"""

from modelgen.cli import measuring as _measuring  # noqa: F401  its verbs join the others
from modelgen.cli.commands import app


def main() -> None:
    app()
