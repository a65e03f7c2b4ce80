"""Inside jobs imports go one way: what commands share knows no command, and commands know little of each other."""

import ast
from pathlib import Path

import pytest

import motionedit

JOBS = Path(motionedit.__file__).parent / "jobs"
FILES = sorted(JOBS.rglob("*.py"))
SHARED = {"batch": set(), "clip": {"batch"}}
# The file of another command that is read, and the page that both edits have written.
HANDED_OVER = {
    "fit_pca": {"normalize.normalization_file"},
    "edit_pc": {"preview.with_page"},
    "edit_prioritized": {"preview.with_page"},
    # Whether a spec fits a clip its command says, and what unit it is likely in, `info`.
    "check": {
        "edit_pc.job",
        "edit_pc.without_model",
        "edit_prioritized.job",
        "edit_prioritized.reference",
        "fit_pca.asked",
        "normalize.common_timeline",
        "normalize.measures",
        "info.job",
    },
}


def imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("motionedit.jobs."):
            yield node.module.removeprefix("motionedit.jobs.")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(JOBS).as_posix())
def test_a_job_imports_what_is_shared_and_what_is_handed_over_to_it(path):
    room = path.relative_to(JOBS).parts[0].removesuffix(".py")
    for module in imported(path):
        other = module.partition(".")[0]
        if other == room:
            continue
        if room in SHARED:
            assert other in SHARED[room], f"{room} imports {module}"
        else:
            assert other in SHARED or module in HANDED_OVER.get(room, ()), f"{room} imports {module}"
