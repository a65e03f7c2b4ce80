"""Small clips and specs for the command line."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from prioritized_edits import edits_in
from small_motions import make_motion

from motionedit.cli import main
from motionedit.core.bvh import new_bytes


@pytest.fixture(scope="module")
def configs():
    return Path(__file__).resolve().parents[2] / "configs"


@pytest.fixture(scope="module")
def data(configs):
    return configs.parent / "data" / "golf"


@pytest.fixture
def clip(tmp_path):
    """Return a writer of clips: clip("a/walk.bvh", seed=1) makes the file and returns its path."""

    def write(name="walk.bvh", **motion):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(new_bytes(make_motion(**motion)))
        return path

    return write


@pytest.fixture
def write_motion(tmp_path):
    """Return a writer of motions: write_motion("person.bvh", motion) makes the file and returns its path."""

    def write(name, motion):
        path = tmp_path / name
        path.write_bytes(new_bytes(motion))
        return path

    return write


@pytest.fixture
def copy_spec(tmp_path):
    """Return a spec that changes nothing."""
    path = tmp_path / "copy.yaml"
    path.write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\n")
    return path


@pytest.fixture
def run(monkeypatch, tmp_path):
    """Return a runner of command lines in the test's folder: its `exit_code`, `stdout`, `stderr`."""
    monkeypatch.chdir(tmp_path)

    def invoke(*arguments, stdin=None):
        result = CliRunner().invoke(main, [str(argument) for argument in arguments], input=stdin)
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return invoke


@pytest.fixture
def edit(run, tmp_path):
    """Return a runner of edit-prioritized: constraints, options of the command, and further keys of the spec."""
    return edits_in(tmp_path, run)
