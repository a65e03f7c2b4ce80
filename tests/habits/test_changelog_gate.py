"""The changelog gate opens for a line under [Unreleased], or for the word that no user notices anything."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

GATE = Path(__file__).resolve().parents[2] / ".ci" / "changelog.py"
BEFORE = "# Changelog\n\n## [Unreleased]\n\n### Added\n\n- `info`.\n\n## [0.1.0] - 2026-01-31\n\n- `edit`.\n"
WITH_A_LINE = BEFORE.replace("- `info`.\n", "- `info`.\n- `cut`.\n")

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="there is no git here")


class Repository:
    """A throw-away repository, with nothing of the machine's settings."""

    def __init__(self, folder, home):
        self.folder = folder
        names = {f"GIT_{role}_{what}": "a@b" for role in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("GIT_", "CHANGELOG_"))}
        self.environment = {**kept, **names, "HOME": str(home), "GIT_CONFIG_NOSYSTEM": "1"}

    def git(self, *arguments):
        done = subprocess.run(
            ["git", "-c", "protocol.file.allow=always", *map(str, arguments)],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.strip()

    def commit(self, message="Change", **files):
        for name, text in files.items():
            path = self.folder / PLACES.get(name, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")
        self.git("add", "--all")
        self.git("commit", "--quiet", "--allow-empty", "--message", message)
        return self.git("rev-parse", "HEAD")

    def gate(self, *arguments, **variables):
        """Return the gate's exit code and its line."""
        done = subprocess.run(
            [sys.executable, GATE, *arguments],
            cwd=self.folder,
            env={**self.environment, **variables},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.stderr == ""
        assert done.stdout.count("\n") == 1
        return done.returncode, done.stdout


PLACES = {
    "changelog": "CHANGELOG.md",
    "code": "motionedit/edit.py",
    "other": "motionedit/other.py",
    "spec": "configs/walk.yaml",
    "page": "docs/spec.md",
    "unseen": "tests/test_edit.py",
    "design": "docs/design.md",
}


@pytest.fixture
def repository(tmp_path):
    """Return a repository without a remote: one commit on main, and a branch that stands on it."""
    (tmp_path / "work").mkdir()
    made = Repository(tmp_path / "work", tmp_path)
    made.git("init", "--quiet", "--initial-branch=main")
    made.commit("Begin", changelog=BEFORE, code="1\n")
    made.git("switch", "--quiet", "--create", "branch")
    return made


@pytest.fixture
def clone(repository, tmp_path):
    """Return a maker of clones of the repository."""

    def make(*options):
        repository.git("clone", "--quiet", *options, repository.folder.as_uri(), tmp_path / "clone")
        return Repository(tmp_path / "clone", tmp_path)

    return make


@pytest.mark.parametrize("what", ["code", "spec", "page"])
def test_what_a_user_can_notice_needs_a_line(repository, what):
    repository.commit(**{what: "new\n"})
    code, line = repository.gate()
    assert code == 1
    assert f"changes of {PLACES[what]}; say it under [Unreleased] in CHANGELOG.md; or" in line
    repository.commit(changelog=WITH_A_LINE)
    assert repository.gate()[0] == 0


@pytest.mark.parametrize("what", ["unseen", "design"])
def test_what_no_user_sees_needs_none(repository, what):
    repository.commit(**{what: "new\n"})
    code, line = repository.gate()
    assert (code, "nothing that a user can notice" in line) == (0, True)


@pytest.mark.parametrize(
    "text",
    [
        BEFORE.replace("- `edit`.\n", "- `edit`.\n- `cut`.\n"),
        BEFORE.replace("### Added\n\n- `info`.\n\n", ""),
        BEFORE.replace("### Added\n", "### Added\n\n### Fixed\n"),
        BEFORE.replace("- `info`.\n", "\n- `info`.\n\n"),
    ],
    ids=["in a release", "taken away", "a heading", "blanks"],
)
def test_a_change_of_the_changelog_that_says_nothing_new_is_no_line(repository, text):
    repository.commit(code="2\n", changelog=text)
    assert repository.gate()[0] == 1


def test_lines_that_a_release_took_with_it_count(repository):
    repository.commit(code="2\n", changelog=WITH_A_LINE)
    released = WITH_A_LINE.replace("## [Unreleased]\n", "## [Unreleased]\n\n## [0.2.0] - 2026-02-01\n")
    repository.commit("Release 0.2.0", changelog=released)
    assert repository.gate()[0] == 0


@pytest.mark.parametrize(
    "word", ["Changelog: none", "changelog: None (moves alone)", "Changelog: none\nSigned-off-by: a"]
)
def test_a_commit_may_say_that_nobody_will_notice(repository, word):
    repository.commit(f"Move\n\nWhy.\n\n{word}", code="2\n")
    assert repository.gate()[0] == 0


@pytest.mark.parametrize(
    "message", ["Move\n\nChangelog: none of these\nwords end it.\n\nThe end.", "Move\n\nChangelog: no"]
)
def test_the_word_stands_at_the_end_and_is_none(repository, message):
    repository.commit(message, code="2\n")
    assert repository.gate()[0] == 1


def test_the_word_speaks_for_its_own_commit_alone(repository):
    repository.commit("Move\n\nChangelog: none", code="2\n")
    repository.commit("Change", code="3\n", other="1\n")
    repository.commit("Move again\n\nChangelog: none", code="4\n")
    code, line = repository.gate()
    assert code == 1
    assert "changes of motionedit/edit.py, motionedit/other.py;" in line


def test_what_was_put_back_is_no_change(repository):
    repository.commit(code="2\n")
    repository.commit(code="1\n")
    assert repository.gate()[0] == 0


def test_a_name_of_any_letters_is_told(repository):
    repository.commit(**{"motionedit/Ä b.py": "1\n"})
    assert repository.gate(PYTHONUTF8="1")[0] == 1
    assert repository.gate(PYTHONUTF8="0", LC_ALL="C", PYTHONIOENCODING="ascii")[0] == 1


def test_what_the_default_branch_did_meanwhile_is_not_this_branchs(repository):
    repository.commit(unseen="1\n")
    repository.git("switch", "--quiet", "main")
    repository.commit(code="2\n")
    repository.git("switch", "--quiet", "branch")
    assert repository.gate()[0] == 0
    repository.git("merge", "--quiet", "--no-edit", "main")
    assert repository.gate()[0] == 0


def test_a_merge_needs_no_word_of_its_own(repository):
    repository.commit("Move\n\nChangelog: none", code="2\n")
    repository.git("switch", "--quiet", "main")
    repository.commit(code="3\n")
    repository.git("switch", "--quiet", "branch")
    with pytest.raises(subprocess.CalledProcessError):
        repository.git("merge", "--quiet", "main")
    repository.commit("Merge", code="2 and 3\n")
    assert repository.gate()[0] == 0


def test_a_clone_compares_with_its_remotes_default_branch(repository, clone):
    repository.git("switch", "--quiet", "main")
    copy = clone()
    assert copy.gate()[0] == 0
    copy.commit(code="2\n")
    assert copy.gate()[0] == 1


@pytest.mark.parametrize("how", ["argument", "variable"])
def test_a_pull_request_compares_with_its_base(repository, how):
    base = repository.git("rev-parse", "main")
    repository.commit(code="2\n")
    repository.git("switch", "--quiet", "--detach", "main")
    repository.git("merge", "--quiet", "--no-ff", "--no-edit", "branch")
    repository.git("branch", "--delete", "--force", "main", "branch")
    assert (repository.gate(base) if how == "argument" else repository.gate(CHANGELOG_BASE=base))[0] == 1


def test_on_the_default_branch_without_a_remote_there_is_nothing_to_compare_with(repository):
    repository.git("switch", "--quiet", "main")
    repository.commit(code="2\n")
    assert repository.gate() == (0, "changelog: HEAD is main, and there is no remote; nothing is compared\n")


def test_a_shallow_clone_says_that_it_cannot_tell(repository, clone):
    repository.commit(code="2\n")
    repository.git("switch", "--quiet", "main")
    copy = clone("--depth=1", "--no-single-branch", "--branch=branch")
    code, line = copy.gate()
    assert (code, "no history shared with origin/" in line) == (0, True)
    copy.git("fetch", "--quiet", "--unshallow")
    assert copy.gate()[0] == 1


def test_a_shallow_clone_of_one_branch_says_that_it_cannot_tell(repository, clone):
    repository.commit(code="2\n")
    copy = clone("--depth=1", "--branch=branch")
    copy.git("remote", "set-head", "origin", "--delete")
    assert copy.gate() == (0, "changelog: no default branch here; nothing is compared\n")


def test_a_new_branch_that_has_no_base_yet_compares_with_the_default_branch(repository):
    repository.commit(code="2\n")
    assert repository.gate(CHANGELOG_BASE="0" * 40)[0] == 1


@pytest.mark.parametrize("base", ["1" * 40, "nowhere", "--help"])
def test_a_base_that_is_not_here_is_said(repository, base):
    assert repository.gate(CHANGELOG_BASE=base) == (0, f"changelog: no commit {base} here; nothing is compared\n")


def test_a_folder_that_is_no_repository_passes(tmp_path):
    (tmp_path / "plain").mkdir()
    plain = Repository(tmp_path / "plain", tmp_path)
    plain.environment["GIT_CEILING_DIRECTORIES"] = str(tmp_path)
    said = (0, "changelog: no git, or no commit here; nothing is compared\n")
    assert plain.gate() == said
    assert plain.gate(PATH="") == said
    plain.git("init", "--quiet")
    assert plain.gate() == said
