"""What a checker, a notebook and `help` see of the face."""

import os
import subprocess
import sys
import typing
from pathlib import Path

import pytest

import motionedit

ROOT = Path(__file__).resolve().parents[2]
FUNCTIONS = ("read", "write", "normalize", "fit_pca", "edit_pc", "edit_prioritized")

PROGRAM = """\
from collections.abc import Mapping
import numpy as np
import motionedit

def own(clip: motionedit.Clip, hits: Mapping[str, np.int64]) -> motionedit.Clip:
    try:
        edit: motionedit.Edited = motionedit.edit_prioritized(clip, {"constraints": []}, events=hits, lenient=True)
        edit = motionedit.edit_prioritized(edit, "reach.yaml", events={"hit": 4}, threads=np.int64(2))
    except motionedit.SpecError as error:
        raise SystemExit(f"{error.key} {error.line}") from error
    motionedit.normalize([clip, edit, "walk.bvh"], {})
    motionedit.write(edit.clip.with_motion(clip.motion), "walk.bvh")
    return edit.clip
"""


@pytest.mark.slow
def test_a_strict_checker_takes_a_users_types(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    options = ["--strict", "--follow-imports", "silent", "--cache-dir", str(tmp_path / "cache")]
    command = [sys.executable, "-m", "mypy", *options, str(program)]
    environment = {**os.environ, "MYPYPATH": str(ROOT)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_types_that_signatures_name_are_found(name):
    assert "return" in typing.get_type_hints(getattr(motionedit, name))


@pytest.mark.parametrize("name", ["Edited", "Fitted", "Normalized"])
def test_the_types_of_results_are_found(name):
    result = getattr(motionedit, name)
    assert typing.get_type_hints(result)["inputs"] is not None
    assert "return" in typing.get_type_hints(result.write)
    assert typing.get_type_hints(result.clip.fget if name != "Edited" else result.page)["return"] is not None


def test_only_public_names_are_listed():
    assert [name for name in dir(motionedit) if not name.startswith("__")] == [
        name for name in motionedit.__all__ if not name.startswith("__")
    ]
    assert "__version__" in dir(motionedit)


def test_what_is_many_numbers_is_shown_in_one_line(fitted, normalized):
    assert repr(motionedit.read("data/walk.bvh").motion) == "<Motion: 145 frames, 31 joints, 24 Hz>"
    assert repr(fitted.model) == "<MotionModel: 9 components of 10 clips, 131 frames, 25 Hz>"
    assert repr(normalized.normalization) == "<Normalization: 10 clips, 131 frames, 25 Hz>"


@pytest.mark.parametrize("name", ["normalize", "fit_pca", "edit_pc", "edit_prioritized"])
def test_help_says_where_the_keys_of_a_spec_are_told(name):
    text = getattr(motionedit, name).__doc__
    assert "docs/spec.md" in text
    assert f"``motionedit schema {name.replace('_', '-')}``" in " ".join(text.split())


def test_help_names_all_types_of_constraints():
    from motionedit.spec.constraint_types import TYPES

    *first, last = TYPES
    assert f"{', '.join(first)} and {last}" in " ".join(motionedit.edit_prioritized.__doc__.split())
