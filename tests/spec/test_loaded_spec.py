"""What a job gets: lines for its own errors, paths, a spec that travels to workers."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from contract import EDIT_PRIORITIZED

from motionedit.errors import EXIT_USAGE, MotionEditError, SpecError
from motionedit.spec.load import load_spec


@pytest.fixture
def stairs(load):
    return load(EDIT_PRIORITIZED, "edit-prioritized", "constraints.eyes.axis=[0, 1, 0]", head=False)


def test_an_error_has_the_line_of_its_key(stairs):
    line = (
        EDIT_PRIORITIZED.splitlines().index("    relative_to: Spine1            # positions are in that joint's frame")
        + 1
    )
    error = stairs.error(("constraints", 5, "relative_to"), "no joint 'Spine1' in walk.bvh")
    assert str(error) == f"spec.yaml:{line}: constraints.5.relative_to: no joint 'Spine1' in walk.bvh"
    assert (error.exit_code, error.file, error.line, error.key) == (
        EXIT_USAGE,
        "spec.yaml",
        line,
        "constraints.5.relative_to",
    )


def test_an_error_at_a_key_that_is_not_given_has_the_line_above(stairs):
    at_item = stairs.error(("constraints", 1), "x").line
    assert stairs.error(("constraints", 1, "recruit", "joints", 3), "x").line == at_item
    assert stairs.error(("nothing", "here"), "x").line == 1
    assert stairs.error((), "x").line == 1


def test_an_error_at_an_overridden_key_names_the_option(stairs):
    assert str(stairs.error(("constraints", 7, "axis"), "x")) == "--set constraints.eyes.axis: x"


def test_given_keys_are_known(stairs):
    assert stairs.has(("constraints", 5, "recruit", "up_to"))
    assert stairs.has(("constraints", 0, "points", 2))
    assert not stairs.has(("constraints", 0, "recruit"))
    assert not stairs.has(("constraints", 99))


def test_a_loaded_spec_travels_to_a_worker(stairs):
    copy = pickle.loads(pickle.dumps(stairs))  # noqa: S301 (its own bytes)
    assert copy == stairs
    assert copy.model.constraints[2].effector_keys == ("constraints", 1, "effector", 1)
    assert str(copy.error(("curve",), "x")) == str(stairs.error(("curve",), "x"))


def test_a_model_cannot_be_changed(stairs):
    with pytest.raises(AttributeError, match="frozen"):
        stairs.model.curve = "index"


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (Path("missing.yaml"), "missing.yaml: no such file"),
        (Path(), ".: a folder, not a file"),
        (Path("a\0b"), "a\0b: not a file name"),
        (Path("x" * 300), f"{'x' * 300}: File name too long"),
    ],
)
def test_a_file_that_cannot_be_read_is_answered_with_the_reason(path, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(MotionEditError) as caught:
        load_spec(path, "edit-pc")
    assert [str(error) for error in caught.value.errors] == [message]
    assert isinstance(caught.value.errors[0], SpecError)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission_is_answered_with_the_reason(tmp_path):
    path = tmp_path / "spec.yaml"
    path.touch(mode=0o000)
    with pytest.raises(MotionEditError) as caught:
        load_spec(path, "edit-pc")
    assert "no permission to read it" in str(caught.value.errors[0])


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="the system has no endless device")
def test_a_device_without_end_is_not_read_to_its_end():
    with pytest.raises(MotionEditError) as caught:
        load_spec(Path("/dev/zero"), "edit-pc")
    assert str(caught.value.errors[0]) == "/dev/zero: a pipe or a device, not a file"


def test_naming_the_specs_loads_no_yaml():
    code = "import sys, motionedit.spec; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"yaml", "numpy"} & set(done.stdout.split())


def test_loading_a_spec_loads_no_numpy(tmp_path):
    path = tmp_path / "spec.yaml"
    path.write_text(EDIT_PRIORITIZED)
    code = (
        "import sys; from pathlib import Path; from motionedit.spec.load import load_spec\n"
        f"load_spec(Path({str(path)!r}), 'edit-prioritized'); print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "scipy", "click"} & set(done.stdout.split())


def test_more_constraints_than_can_be_solved_in_any_time_are_refused_in_words():
    spec = {"constraints": [{"type": "position", "effector": "LeftHand", "priority": n} for n in range(1000)]}
    with pytest.raises(MotionEditError, match="constraints: are 1000; one spec has 100 at most"):
        load_spec(spec, "edit-prioritized")
