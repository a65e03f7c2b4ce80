"""The pages of the documentation, and the scripts that generate them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))

import sessions  # noqa: E402

PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]


@pytest.fixture(params=PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def page(request):
    return request.param


@pytest.fixture
def root():
    return ROOT


@pytest.fixture
def shell(root, tmp_path):
    """Return a runner of lines in a folder that has data/ and configs/, as a build server runs them."""
    sessions.working_copy(root, tmp_path)
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))

    def run(line, **variables):
        done = subprocess.run(
            ["/bin/sh", "-e", "-c", line],
            cwd=tmp_path,
            env={**os.environ, "PATH": path, **variables},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    return run
