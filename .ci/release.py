"""Checks of a release: the places that name the version agree, the changelog has its section, and each file is there.

Usage: python .ci/release.py [--tag v1.2.3] [--artifacts FOLDER]

Without options: the places agree, and the changelog is not ahead of them. With a tag: all is ready to be released as
that version. With a folder: it holds the sdist and the wheels of the version, and nothing else.
"""

from __future__ import annotations

import argparse
import re
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

# A wheel's name ends so, whatever the oldest system that it serves: one for each platform, by the stable ABI.
WHEELS = (
    r"manylinux\S*_x86_64",
    r"manylinux\S*_aarch64",
    r"macosx\S*_x86_64",
    r"macosx\S*_arm64",
    r"win_amd64",
)
_VERSION = re.compile(r"\d+\.\d+\.\d+")
_SECTION = re.compile(r"^## \[(\d[^\]]*)\](?: - (\d{4}-\d\d-\d\d))?$", re.MULTILINE)


def main(arguments: list[str]) -> int:
    """Return 0 where all is as it should be; say what is not, a line each."""
    parser = argparse.ArgumentParser(description="Check what a release needs.")
    parser.add_argument("--tag", help="the tag that is to be released")
    parser.add_argument("--artifacts", type=Path, help="the folder of files that are to be published")
    options = parser.parse_args(arguments)
    root = Path()
    found = versions(root)
    version = found["pyproject.toml"]
    complaints = [*disagreements(found), *changelog_faults(root, version)]
    if options.tag is not None:
        complaints += tag_faults(root, version, options.tag)
    if options.artifacts is not None:
        complaints += artifact_faults(version, sorted(path.name for path in options.artifacts.iterdir()))
    for complaint in complaints:
        print(f"release: error: {complaint}")
    if not complaints:
        print(f"release: {version} everywhere")
    return 1 if complaints else 0


def versions(root: Path) -> dict[str, str]:
    """Return the version by the file that names it."""
    init, citation = "motionedit/version.py", "CITATION.cff"
    return {
        "pyproject.toml": tomllib.loads(_text(root, "pyproject.toml"))["project"]["version"],
        init: _only(r'^__version__ = "(.*)"$', _text(root, init)),
        citation: _only(r"^version: (.*)$", _text(root, citation)),
    }


def disagreements(found: dict[str, str]) -> Iterator[str]:
    """Yield where the version is another one than in pyproject.toml, or has another form than 1.2.3."""
    version = found["pyproject.toml"]
    if not _VERSION.fullmatch(version):
        yield f"pyproject.toml: version {version}; a release is three numbers, as 1.2.3"
    for place, other in found.items():
        if other != version:
            yield f"{place}: version {other or 'missing'}; pyproject.toml says {version}"


def changelog_faults(root: Path, version: str) -> Iterator[str]:
    """Yield a newest release in the changelog that is newer than the version."""
    newest = _SECTION.search(_text(root, "CHANGELOG.md"))
    if newest and _numbers(newest[1]) > _numbers(version):
        yield f"CHANGELOG.md: its newest release is {newest[1]}; pyproject.toml says {version}"


def tag_faults(root: Path, version: str, tag: str) -> Iterator[str]:
    """Yield what is not ready: another tag than the version's, no section with its date, or lines left above it."""
    if tag != f"v{version}":
        yield f"tag {tag}; pyproject.toml says {version}, so the tag is v{version}"
    text = _text(root, "CHANGELOG.md")
    newest = _SECTION.search(text)
    if newest is None or newest[1] != version or newest[2] is None:
        yield f"CHANGELOG.md: its newest release is not '## [{version}] - YYYY-MM-DD'"
    elif re.search(r"^- ", text[: newest.start()], re.MULTILINE):
        yield f"CHANGELOG.md: lines under [Unreleased]; they belong under [{version}]"


def artifact_faults(version: str, names: list[str]) -> Iterator[str]:
    """Yield files that lack and files that do not belong, of those to be published."""
    wanted = [rf"motionedit-{re.escape(version)}\.tar\.gz"]
    wanted += [rf"motionedit-{re.escape(version)}-cp311-abi3-{platform}\.whl" for platform in WHEELS]
    for pattern in wanted:
        if sum(re.fullmatch(pattern, name) is not None for name in names) != 1:
            yield f"not one file named {pattern}"
    for name in names:
        if not any(re.fullmatch(pattern, name) for pattern in wanted):
            yield f"{name} is no file of a release of {version}"


def _text(root: Path, name: str) -> str:
    return (root / name).read_text(encoding="utf-8")


def _only(pattern: str, text: str) -> str:
    found = re.search(pattern, text, re.MULTILINE)
    return found[1] if found else ""


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", version))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
