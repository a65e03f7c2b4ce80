"""The version is one in all places, and a release is refused until all that it needs is there."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PLACES = {
    "pyproject.toml": '[project]\nversion = "0.2.0"\n',
    "motionedit/version.py": '__version__ = "0.2.0"\n',
    "CITATION.cff": "cff-version: 1.2.0\nversion: 0.2.0\n",
    "CHANGELOG.md": "# Log\n\n## [Unreleased]\n\n## [0.2.0] - 2026-02-01\n\n- `cut`.\n\n## [0.1.0] - 2026-01-31\n",
}
FILES = [
    "motionedit-0.2.0.tar.gz",
    "motionedit-0.2.0-cp311-abi3-manylinux_2_27_x86_64.manylinux_2_28_x86_64.whl",
    "motionedit-0.2.0-cp311-abi3-manylinux_2_27_aarch64.manylinux_2_28_aarch64.whl",
    "motionedit-0.2.0-cp311-abi3-macosx_10_13_x86_64.whl",
    "motionedit-0.2.0-cp311-abi3-macosx_11_0_arm64.whl",
    "motionedit-0.2.0-cp311-abi3-win_amd64.whl",
]


def check(folder, *arguments):
    command = [sys.executable, ROOT / ".ci" / "release.py", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return done.returncode, done.stdout


@pytest.fixture
def tree(tmp_path):
    """Return a maker of a tree that is ready to be released as 0.2.0, but for the words that are replaced in a file."""

    def make(place=None, *words):
        for name, text in PLACES.items():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(text.replace(*words) if name == place else text, encoding="utf-8")
        return tmp_path

    return make


@pytest.fixture
def artifacts(tmp_path):
    """Return a maker of a folder of empty files."""

    def make(names):
        (tmp_path / "dist").mkdir()
        for name in names:
            (tmp_path / "dist" / name).touch()
        return tmp_path / "dist"

    return make


def test_the_version_is_one_in_all_places():
    code, said = check(ROOT)
    assert code == 0, said


def test_a_tree_that_is_ready_may_be_released(tree, artifacts):
    assert check(tree(), "--tag", "v0.2.0", "--artifacts", artifacts(FILES)) == (0, "release: 0.2.0 everywhere\n")


@pytest.mark.parametrize("place", ["motionedit/version.py", "CITATION.cff"])
@pytest.mark.parametrize("other", ["0.1.0", ""])
def test_a_place_with_another_version_or_none_is_named(tree, place, other):
    code, said = check(tree(place, "0.2.0", other))
    assert code == 1
    assert f"{place}: version {other or 'missing'}" in said


def test_a_version_is_three_numbers(tree):
    code, said = check(tree("pyproject.toml", "0.2.0", "0.2.dev1"))
    assert code == 1
    assert "a release is three numbers" in said


def test_before_a_release_the_changelog_may_be_behind_and_not_ahead(tree):
    assert check(tree("CHANGELOG.md", "0.2.0", "0.1.9"))[0] == 0
    assert check(tree("CHANGELOG.md", "0.2.0", "0.10.0"))[0] == 1


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (("## [0.2.0] - 2026-02-01\n", ""), "its newest release is not '## [0.2.0]"),
        ((" - 2026-02-01", ""), "its newest release is not '## [0.2.0]"),
        (("## [Unreleased]\n", "## [Unreleased]\n\n- More.\n"), "lines under [Unreleased]"),
    ],
    ids=["no section", "no date", "lines left"],
)
def test_a_tag_asks_for_the_section_of_its_version(tree, words, fault):
    folder = tree("CHANGELOG.md", *words)
    assert check(folder)[0] == 0
    code, said = check(folder, "--tag", "v0.2.0")
    assert code == 1
    assert fault in said


def test_a_tag_is_the_version_after_a_v(tree):
    code, said = check(tree(), "--tag", "v0.3.0")
    assert code == 1
    assert "so the tag is v0.2.0" in said


@pytest.mark.parametrize("lacking", FILES)
def test_each_file_of_a_release_is_asked_for(tree, artifacts, lacking):
    code, said = check(tree(), "--artifacts", artifacts([name for name in FILES if name != lacking]))
    assert (code, said.count("\n"), said.count("not one file named")) == (1, 1, 1)


@pytest.mark.parametrize("name", ["motionedit-0.1.0.tar.gz", "motionedit-0.2.0-cp311-cp311-win_amd64.whl", "notes.txt"])
def test_no_other_file_is_published(tree, artifacts, name):
    code, said = check(tree(), "--artifacts", artifacts([*FILES, name]))
    assert (code, said) == (1, f"release: error: {name} is no file of a release of 0.2.0\n")
