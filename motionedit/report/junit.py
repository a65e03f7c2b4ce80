"""JUnit XML of clips that were compared or checked, which build servers show test by test."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal
from xml.sax.saxutils import quoteattr

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence


Problem = Literal["failure", "error"]


@dataclass(frozen=True)
class Case:
    """One clip: `problem` is None where it passed; a failure is what was looked for, an error that nothing was."""

    name: str
    problem: Problem | None = None
    message: str = ""


def junit_bytes(suite: str, cases: Sequence[Case]) -> bytes:
    """Return a test suite with one case per clip, as UTF-8 XML; no times, so that two reports compare."""
    failures = sum(case.problem == "failure" for case in cases)
    errors = sum(case.problem == "error" for case in cases)
    counts = f'tests="{len(cases)}" failures="{failures}" errors="{errors}"'
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<testsuites {counts}>",
        f"  <testsuite name={_attribute(suite)} {counts}>",
        *(_case(suite, case) for case in cases),
        "  </testsuite>",
        "</testsuites>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _case(suite: str, case: Case) -> str:
    head = f"    <testcase classname={_attribute(suite)} name={_attribute(case.name)}"
    if case.problem is None:
        return f"{head}/>"
    return f"{head}><{case.problem} message={_attribute(case.message)}/></testcase>"


def _attribute(text: str) -> str:
    # Control characters, which a file name may hold, are not allowed in XML at all.
    return quoteattr("".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text))
