"""A made-up behaviour for the tests of timeline, PCA and the edit: smooth strokes that differ by a few factors."""

import numpy as np
from human import HIPS_HEIGHT, skeleton_of

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body import ground
from motionedit.core.body.bones import bones_of, travel_joint
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.up import find_up
from motionedit.core.motion import Motion
from motionedit.core.pca.database import DatabaseMotion, FitSettings, build_model, database_space
from motionedit.core.pca.fit import ALL, fit_centred
from motionedit.core.pca.model import DatabaseClip
from motionedit.core.timeline.alignment import align_to, aligned
from motionedit.core.timeline.resample import resample
from motionedit.core.timeline.warp import Timeline, make_warp

FACTORS = 6
HIT = 0.6


def stroke(seed, *, frames=60, hit=None, skeleton=None, frame_time=0.02, heading=0.0, noise=0.0):
    """Return a stroke: `hit` is the share of the clip at which everybody is in the middle of the stroke."""
    skeleton = skeleton or skeleton_of()
    shape = np.random.default_rng(0)
    J = len(skeleton)
    amplitude = shape.normal(scale=0.25, size=(1 + FACTORS, 3, J, 3))
    amplitude[1:] *= 0.25
    factors = np.concatenate(([1.0], np.random.default_rng(seed).normal(size=FACTORS)))
    t = np.linspace(0.0, 1.0, frames)
    phase = np.interp(t, [0.0, hit or HIT, 1.0], [0.0, HIT, 1.0]) if hit else t
    waves = np.stack([np.sin(np.pi * k * phase) for k in (1, 2, 3)], axis=1)
    v = np.einsum("fw,swjc,s->fjc", waves, amplitude, factors)
    if noise:
        v += np.random.default_rng(seed + 1000).normal(scale=noise, size=v.shape)
    rotations = rot.exp(v)
    turn = rot.about_axis(1, np.array(heading))
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    path = np.stack((0.1 * factors[1] * phase, HIPS_HEIGHT + 0.05 * waves[:, 1], 0.3 * phase), axis=1)
    return Motion(skeleton, rotations, rot.rotate(turn, path)[:, None], frame_time)


def place(motion, timeline, *, hit):
    """Return (alignment, warp, travel, up) of a stroke on a timeline."""
    poses, travel = kinematics.forward(motion), travel_joint(motion)
    bones = bones_of(motion, travel)
    anatomy = find_anatomy(bones, poses=poses)
    up = find_up(motion, bones, poses, anatomy, first=0).axis
    frame = ground.heading_frame(poses, anatomy, up=up, frame=0, travel=travel)
    alignment = align_to(frame, heading=True, position=True)
    warp = make_warp(timeline, first=0, last=len(motion) - 1, events={"hit": hit}, label="stroke")
    return alignment, warp, travel, up


def model_of(motions, timeline, hits, settings=None):
    """Return the model of strokes."""
    database = []
    anatomy = find_anatomy(motions[0].skeleton)
    for m, (motion, hit) in enumerate(zip(motions, hits, strict=True)):
        alignment, warp, travel, up = place(motion, timeline, hit=hit)
        at = warp.to_source(np.arange(timeline.frames, dtype=float))
        normalized = aligned(resample(motion, at, frame_time=1 / timeline.frame_rate), alignment, travel=travel)
        clip = DatabaseClip(f"stroke{m}", f"{m:064d}", (("hit", hit),))
        database.append(DatabaseMotion(clip, normalized, np.arange(len(motion.skeleton))))
    settings = settings or FitSettings()
    first = database[0].motion
    space = database_space(first, travel=0, leg_length=anatomy.leg_length, settings=settings)
    vectors = map(space.vector, database)
    rules = {"align": {"heading": True}}
    fitted = build_model(vectors, len(database), of=space, timeline=timeline, up=up, settings=settings, rules=rules)
    return fitted.model


def fitted(motions, *, count=ALL):
    """Return the principal components of motion vectors, shape (M, D)."""
    mean = motions.mean(axis=0)
    return fit_centred(motions - mean, mean, count=count)


TIMELINE = Timeline(61, 50.0, (("hit", 36),))


def database(count=9, **changes):
    """Return (motions, hits) of a database of strokes whose durations and hits differ."""
    motions, hits = [], []
    for seed in range(count):
        frames = 52 + 3 * (seed % 5)
        share = 0.55 + 0.02 * (seed % 4)
        motions.append(stroke(seed, frames=frames, hit=share, **changes))
        hits.append(share * (frames - 1))
    return motions, hits
