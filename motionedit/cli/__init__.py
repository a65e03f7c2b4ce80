"""The command line: one file per command, each parsing, calling its job and printing; `main` runs it all."""

from motionedit.cli.program import main

__all__ = ["main"]
