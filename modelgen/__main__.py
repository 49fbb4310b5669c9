"""`python -m modelgen`: the command line."""

from modelgen.cli import main

main()
