"""A person who moves a little, what tests ask of such a one, and what is said of it."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "unit" / "core"))

from human import BONES, ROOT_CHANNELS, above, skeleton_of, standing, with_rotation

from motionedit.core.motion import Motion

# What is made of bones and joints, for those who make others.
__all__ = ["BONES", "ROOT_CHANNELS", "above", "skeleton_of", "standing", "with_rotation"]

SCALE = 100.0
MEANINGLESS = {name: f"b{i:02d}" for i, (name, _, _) in enumerate(BONES)}


def person(*, bones=BONES, rename=str, frames=40, travels=True):
    """Return a person in centimetres who sways and swings an arm."""
    skeleton = skeleton_of(bones, scale=SCALE, rename=rename)
    motion = standing(skeleton, frames, frame_time=1 / 30, at=(0.0, SCALE * 0.98, 0.0))
    for frame in range(frames):
        swing = 0.4 * np.sin(frame / 6.0)
        motion = with_rotation(motion, rename("LeftArm"), [frame], (swing, 0.2, 0.3))
        motion = with_rotation(motion, rename("LeftLeg"), [frame], (0.2 + 0.1 * swing, 0.0, 0.0))
    translations = motion.translations.copy()
    translations[..., 2] += np.linspace(0.0, 30.0 * travels, frames)[:, None]
    return Motion(skeleton, motion.rotations, translations, motion.frame_time)


def mirrored(motion):
    """Return a motion with x negated, and the names as they were: left is on the right."""
    flip = np.array([-1.0, 1.0, 1.0])
    offsets = motion.skeleton.offsets * flip
    sites = tuple(replace(site, offset=site.offset * flip) for site in motion.skeleton.end_sites)
    skeleton = replace(motion.skeleton, offsets=offsets, end_sites=sites)
    rotations = motion.rotations * np.array([1.0, 1.0, -1.0, -1.0])
    return Motion(skeleton, rotations, motion.translations * flip, motion.frame_time)


def spec(tmp_path, *constraints, **keys):
    path = tmp_path / "spec.yaml"
    path.write_text(json.dumps({"schema": "motionedit/edit-prioritized/v1", "constraints": constraints, **keys}))
    return path


def record(run, *arguments):
    done = run(*arguments, "--report", "r.json")
    (entry,) = json.loads(Path("r.json").read_text())["clips"]
    return done, entry


def limb(*parts):
    return [MEANINGLESS[part] for part in parts]
