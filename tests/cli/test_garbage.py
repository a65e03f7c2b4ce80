"""What a clip took is given back when its turn is over: nothing of it is in a circle, for which memory would wait."""

import gc

import numpy as np
import pytest

from motionedit.core.motion import Motion


@pytest.fixture
def commands(run, configs, data, tmp_path):
    """Return command lines on real files, by their names."""
    walk, model = data.parent / "walk.bvh", tmp_path / "m.npz"
    run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", tmp_path / "n")
    run("fit-pca", tmp_path / "n", "-o", model)
    edit = ("edit-prioritized", walk, "-o", "w.bvh", "-s")
    return {
        "reach": (*edit, configs / "reach.yaml"),
        "footplants": (*edit, configs / "footplants.yaml"),
        "feet back": (*edit, configs / "feet-back.yaml", "--reference", walk),
        "golf": ("edit-pc", data, "-m", model, "-s", configs / "golf-edit.yaml", "-o", "o"),
        "normalize": ("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n2"),
        "check": ("check", walk),
        "info": ("info", walk, "--contacts"),
    }


@pytest.mark.parametrize("name", ["reach", "footplants", "feet back", "golf", "normalize", "check", "info"])
def test_a_clip_leaves_nothing_in_a_circle(run, commands, name):
    gc.collect()
    gc.disable()
    try:
        assert run(*commands[name]).exit_code == 0
        gc.set_debug(gc.DEBUG_SAVEALL)
        gc.collect()
        kept = [each for each in gc.garbage if isinstance(each, (Motion, np.ndarray))]
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
        gc.enable()
    assert not kept
