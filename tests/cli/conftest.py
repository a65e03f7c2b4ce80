"""Small clips and specs for the command line."""

import numpy as np
import pytest
from channels import motion_from_channels
from click.testing import CliRunner

from motionedit.cli import main
from motionedit.core.bvh import new_bytes
from motionedit.core.skeleton import EndSite, Skeleton

_ROOT = ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
_JOINT = ("Zrotation", "Xrotation", "Yrotation")


def make_motion(*, frames=8, seed=0, frame_time=1 / 30, names=("Hips", "LeftArm", "LeftForeArm")):
    """Return a chain that moves a little, each joint 10 above its parent."""
    offsets = np.array([[0.0, 0.0, 0.0], *([[0.0, 10.0, 0.0]] * (len(names) - 1))])
    skeleton = Skeleton(
        tuple(names),
        np.arange(-1, len(names) - 1),
        offsets,
        (_ROOT, *([_JOINT] * (len(names) - 1))),
        (EndSite(len(names) - 1, np.array([0.0, 10.0, 0.0])),),
    )
    steps = np.random.default_rng(seed).normal(size=(frames, skeleton.channel_count))
    return motion_from_channels(skeleton, 10.0 + np.cumsum(steps, axis=0), frame_time=frame_time)


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
