"""A clip whose motion is not that of its text means its motion, whatever it is given to: no old one is mixed in."""

import copy
import pickle
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import motionedit

ROOT = Path(__file__).resolve().parents[2]
NOTHING = {"constraints": []}
FEET = ["LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase"]
HAND = {"type": "position", "effector": "LeftHand", "priority": 4, "points": [{"at": 70, "shift": [0, 15, 0]}]}
REACH = {"constraints": [{"type": "position", "effector": FEET, "priority": 10}, HAND]}
BALL = {"goals": [{"at": 66, "effector": {"end_site": "Club"}, "shift": [0, 0, 3]}]}


# No file's text has the last digit: what was computed without the text is told from what was written.
HIGHER = np.array([0.0, 20.00000001, 0.0])


def raised(motion):
    return replace(motion, translations=motion.translations + HIGHER)


def changed_in_place(clip):
    clip.motion.translations[:] += HIGHER
    return clip


OTHERS = {
    "replaced": lambda clip: replace(clip, motion=raised(clip.motion)),
    "unpickled": lambda clip: changed_in_place(pickle.loads(pickle.dumps(clip))),  # noqa: S301  our own
    "copied": lambda clip: changed_in_place(copy.deepcopy(clip)),
}


@pytest.fixture
def walk():
    return motionedit.read("data/walk.bvh")


@pytest.fixture(params=list(OTHERS))
def mine(request):
    return OTHERS[request.param]


def test_an_edit_of_nothing_returns_the_motion_that_was_meant(walk, mine):
    edit = motionedit.edit_prioritized(mine(walk), NOTHING)
    assert edit.clip.text.data == walk.with_motion(raised(walk.motion)).text.data
    assert edit.clip.motion.translations == pytest.approx(raised(walk.motion).translations, abs=1e-6)
    assert edit.clip.label == walk.label


def test_an_edit_has_the_meant_motion_inside_and_outside_its_interval(walk, mine):
    edit = motionedit.edit_prioritized(mine(walk), REACH).clip
    same = motionedit.edit_prioritized(walk.with_motion(raised(walk.motion)), REACH).clip
    assert edit.text.data == same.text.data
    steps = np.abs(np.diff(edit.motion.translations[:, 0], axis=0)).max()
    assert steps < 2.0 * np.abs(np.diff(walk.motion.translations[:, 0], axis=0)).max()


def test_an_edit_by_a_model_and_a_normalization_take_the_meant_motion(fitted, mine):
    swings = [motionedit.read(f"data/golf/swing0{n}.bvh") for n in (4, 5)]
    meant = [clip.with_motion(raised(clip.motion)) for clip in swings]
    given = [mine(clip) for clip in swings]
    events = {"hit": 85}
    edits = [motionedit.edit_pc(clips[0], fitted, BALL, events=events) for clips in (given, meant)]
    assert edits[0].clip.text.data == edits[1].clip.text.data
    both = [motionedit.normalize(clips, {}) for clips in (given, meant)]
    assert [clip.text.data for clip in both[0].clips] == [clip.text.data for clip in both[1].clips]


def test_normalized_and_edited_clips_with_other_motions_are_written_and_learnt_as_meant(mine, walk, tmp_path):
    swings = motionedit.normalize([f"data/golf/swing0{n}.bvh" for n in (1, 2, 3)], {})
    first = swings.clips[0]
    other = replace(swings, clips=(mine(first), *swings.clips[1:]))
    folder = other.write(tmp_path / "golf")
    assert (folder / "swing01.bvh").read_bytes() == first.with_motion(raised(first.motion)).text.data
    models = [motionedit.fit_pca(source).model.components for source in (other, folder)]
    assert (models[0].mean == models[1].mean).all()
    assert (models[0].components == models[1].components).all()
    edit = motionedit.edit_prioritized(walk, NOTHING)
    written = replace(edit, clip=mine(walk)).write(tmp_path / "walk.bvh").read_bytes()
    assert written == walk.with_motion(raised(walk.motion)).text.data


def test_a_motion_that_no_file_of_the_clip_can_hold_is_refused(walk):
    other = replace(walk.motion, skeleton=replace(walk.motion.skeleton, offsets=2.0 * walk.motion.skeleton.offsets))
    for call in (motionedit.edit_prioritized, motionedit.normalize):
        with pytest.raises(motionedit.ClipError, match=r"data/walk\.bvh: its motion has another skeleton"):
            call(replace(walk, motion=other), NOTHING if call is motionedit.edit_prioritized else {})


def test_a_clip_is_written_whole_and_never_over_its_source(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "data" / "walk.bvh", "walk.bvh")
    before = Path("walk.bvh").read_bytes()
    clip = motionedit.read("walk.bvh")
    assert motionedit.write(clip, "copies") == Path("copies/walk.bvh")
    assert Path("copies/walk.bvh").read_bytes() == before
    higher = clip.with_motion(raised(clip.motion))
    assert motionedit.write(higher, "higher.bvh").read_bytes() == higher.text.data
    stale = replace(clip, motion=raised(clip.motion))
    assert motionedit.write(stale, "stale.bvh").read_bytes() == higher.text.data
    Path("elsewhere").mkdir()
    monkeypatch.chdir("elsewhere")
    for one in (clip, higher):
        for name in ("..", "../walk.bvh", tmp_path / "walk.bvh"):
            with pytest.raises(motionedit.UsageError, match="an input is never overwritten"):
                motionedit.write(one, name)
    assert Path("../walk.bvh").read_bytes() == before
    with pytest.raises(motionedit.UsageError, match="not a value of type Edited; it has a method write"):
        motionedit.write(motionedit.edit_prioritized(clip, NOTHING), "x.bvh")
    with pytest.raises(motionedit.UsageError, match=r"not a value of type str$"):
        motionedit.write("walk.bvh", "x.bvh")
