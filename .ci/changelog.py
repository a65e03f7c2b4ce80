"""The changelog gate: a change to what a user can notice needs a line under [Unreleased], or says that nobody will.

Usage: python .ci/changelog.py [BASE]

It looks at the commits since BASE: the argument, else the variable CHANGELOG_BASE, else the default branch. Only what
is committed counts. Where there is nothing to compare with, it says so and passes.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

CHANGELOG = "CHANGELOG.md"
# What a user can notice: the program, the examples, and the pages that say what it takes, writes and answers.
NOTICED = (
    "configs/",
    "docs/cli.md",
    "docs/exit-codes-and-messages.md",
    "docs/files.md",
    "docs/report.schema.json",
    "docs/spec.md",
    "motionedit/",
)
# The default branch, by the names that it has in a clone, and in a repository without a remote.
DEFAULT_BRANCHES = ("origin/HEAD", "origin/main", "origin/master", "main", "master")
_PATHS_SHOWN = 10
_ADVICE = (
    f"say it under [Unreleased] in {CHANGELOG}; or, where no user notices anything, end the message of each commit "
    "with the line 'Changelog: none'"
)


class NothingToCompareError(Exception):
    """There is no commit since which changes could be told."""


def main(arguments: list[str]) -> int:
    """Return 0 where the gate is open, 1 where a line is missing; say which, and why, in a line."""
    try:
        named = arguments[0] if arguments else os.environ.get("CHANGELOG_BASE", "")
        # A workflow calls the commit before the first one of a new branch 000...
        base = base_commit(named if named.strip("0") else "")
        paths = sorted(noticed_paths(base))
        if paths and not new_lines(base):
            more = f" and {len(paths) - _PATHS_SHOWN} more" if len(paths) > _PATHS_SHOWN else ""
            changed = ", ".join(paths[:_PATHS_SHOWN]) + more
            print(f"changelog: error: no new line since {base[:10]}, but changes of {changed}; {_ADVICE}")
            return 1
    except NothingToCompareError as error:
        print(f"changelog: {error}; nothing is compared")
        return 0
    found = "new lines are there" if paths else "nothing that a user can notice"
    print(f"changelog: {found} since {base[:10]}")
    return 0


def base_commit(named: str) -> str:
    """Return the last commit that HEAD shares with the base that is named, or else with the default branch.

    Raises
    ------
    NothingToCompareError
        This is no repository with commits; the base is unknown here, or too far back for a shallow clone.
    """
    head = _commit("HEAD")
    if head is None:
        raise NothingToCompareError("no git, or no commit here")
    tips = [(name, tip) for name in ([named] if named else DEFAULT_BRANCHES) if (tip := _commit(name))]
    if not tips:
        raise NothingToCompareError(f"no commit {named} here" if named else "no default branch here")
    name, tip = tips[0]
    if not named and name in DEFAULT_BRANCHES[-2:] and tip == head:
        raise NothingToCompareError(f"HEAD is {name}, and there is no remote")
    base = git("merge-base", tip, head)
    if base is None:
        raise NothingToCompareError(f"no history shared with {name} here (a shallow clone?)")
    return base


def noticed_paths(base: str) -> Iterator[str]:
    """Yield what a user can notice: files that differ from the base, by a commit that does not say 'none'."""
    changed = set(_split(git("diff", "--name-only", "--no-renames", "-z", base, "HEAD")))
    for commit in (git("rev-list", "--no-merges", f"{base}..HEAD") or "").split():
        if not _says_none(commit):
            touched = _split(git("show", "--format=", "--name-only", "--no-renames", "-z", commit))
            found = {path for path in touched if path.startswith(NOTICED)} & changed
            changed -= found
            yield from found


def new_lines(base: str) -> list[str]:
    """Return the lines under [Unreleased], and under releases made since the base, that were not there at the base."""
    before, now = (git("show", f"{commit}:{CHANGELOG}") or "" for commit in (base, "HEAD"))
    released = set(re.findall(r"^## \[(\d[^\]]*)\]", before, re.MULTILINE))
    added = Counter(_unreleased(now, released)) - Counter(_unreleased(before, released))
    return list(added)


def git(*arguments: str) -> str | None:
    """Return what git prints; None where it fails, or is missing."""
    try:
        done = subprocess.run(["git", *arguments], capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.decode(errors="surrogateescape").rstrip("\n")


def _commit(name: str) -> str | None:
    return git("rev-parse", "--verify", "--quiet", "--end-of-options", f"{name}^{{commit}}")


def _split(names: str | None) -> list[str]:
    return [name for name in (names or "").split("\0") if name]


def _says_none(commit: str) -> bool:
    words = git("show", "--no-patch", "--format=%(trailers:key=Changelog,valueonly)", commit) or ""
    return re.match(r"\s*none\b", words, re.IGNORECASE) is not None


def _unreleased(text: str, released: set[str]) -> Iterator[str]:
    """Yield the list's lines in the sections of [Unreleased] and of versions that are not among the released."""
    inside = False
    for line in text.splitlines():
        heading = re.match(r"## \[([^\]]+)\]", line)
        if heading:
            inside = heading[1] not in released
        elif inside and line.strip() and not line.startswith("#"):
            yield line.strip()


if __name__ == "__main__":
    sys.stdout.reconfigure(errors="backslashreplace")  # a file's name may have letters that the terminal lacks
    sys.exit(main(sys.argv[1:]))
