"""normalization.json is what the library's own writer would make of it, and is read back as it was."""

import json
from dataclasses import replace

import pytest

from motionedit.core.timeline.warp import Timeline
from motionedit.jobs.normalize.normalization_file import (
    NAME,
    Normalization,
    NormalizedClip,
    normalization_bytes,
    read_normalization,
)

CLIP = NormalizedClip(
    clip="a.bvh",
    source='takes/100 % "ü"\n\t%s\\\x00.bvh',
    digest="ab",
    frames=120,
    duration=4.76,
    first=1,
    events={"top": 60.25, "Schlag-größe": 80.0},
    rotation=(1.0, 0.0, -0.1234567890123456, 1e-17),
    origin=(3.0, 0.0, -0.0),
    written="cd",
)
RULES = {
    "align": {"heading": True, "position": True, "at": None, "by": "hips"},
    "rest_pose": "drop",
    "events": {"top": None, "Schlag-größe": None},
}
PLAIN = NormalizedClip("b.bvh", "b.bvh", "ab", 9, 0.32, 0, {}, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), "cd")


def entry(clip):
    return {
        "clip": clip.clip,
        "clip_sha256": clip.written,
        "source": clip.source,
        "sha256": clip.digest,
        "frames": clip.frames,
        "duration": clip.duration,
        "first_frame": clip.first,
        "events": clip.events,
        "alignment": {"rotation": list(clip.rotation), "origin": list(clip.origin)},
    }


@pytest.mark.parametrize("clips", [(), (CLIP,), (CLIP, replace(CLIP, clip="c.bvh"), PLAIN)])
def test_the_file_is_as_the_library_indents_it(clips):
    normalization = Normalization(Timeline(100, 25.0, (("top", 50),)), "y", RULES, clips)
    written = normalization_bytes(normalization).decode()
    content = json.loads(written)
    assert content["clips"] == [entry(clip) for clip in clips]
    assert written == json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def test_it_is_read_back_as_it_was(tmp_path):
    clips = (CLIP, replace(CLIP, clip="c.bvh"))
    normalization = Normalization(Timeline(100, 25.0, (("top", 50), ("Schlag-größe", 70))), "-z", RULES, clips)
    (tmp_path / NAME).write_bytes(normalization_bytes(normalization))
    assert read_normalization(tmp_path) == normalization


def test_a_number_that_is_none_is_not_written():
    normalization = Normalization(Timeline(100, 25.0), "y", RULES, (replace(PLAIN, duration=float("nan")),))
    with pytest.raises(ValueError, match="JSON compliant"):
        normalization_bytes(normalization)
