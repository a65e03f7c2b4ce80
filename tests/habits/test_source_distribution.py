"""The source distribution is the whole project: what git tracks is named in MANIFEST.in."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def named():
    """Return the folders and the files that MANIFEST.in takes."""
    lines = [line.split() for line in (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines()]
    folders = {line[1] for line in lines if line[0] == "graft"}
    return folders, {name for line in lines if line[0] == "include" for name in line[1:]}


@pytest.mark.skipif(shutil.which("git") is None or not (ROOT / ".git").exists(), reason="no checkout")
def test_everything_that_is_tracked_is_distributed():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    folders, files = named()
    tracked = {name.partition("/")[0] for name in listed.split("\0") if name} - {
        "MANIFEST.in",
        "motionedit",
        "pyproject.toml",
    }
    assert tracked == folders | files


def test_what_is_named_is_there():
    folders, files = named()
    assert all((ROOT / name).is_dir() for name in folders)
    assert all((ROOT / name).is_file() for name in files)
