"""To and from `bvhio`, an independent BVH library, and the check of written bytes by its reader.

bvhio works in single precision and loops for ever on a file that ends too soon, so it is only ever given bytes that
this package's own reader has accepted. It is imported where it is used, for it takes longer than a short edit.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.read import Clip, parse_clip
from motionedit.core.bvh.write import hierarchy_lines, plain_number
from motionedit.core.euler import solve_angles
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.rotations import normalize
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.dataclass import dataclass
from motionedit.errors import BvhError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray

# Positions may differ by this part of the leg length: single precision over a chain of joints stays well below.
VERIFY_TOLERANCE = 1e-3
# A middle angle this near a right angle (rad) is gimbal lock.
_LOCK_BAND = 1e-3
_CHANNEL_NAMES = frozenset(f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation"))


@dataclass(frozen=True)
class VerifyResult:
    """What the comparison with bvhio found.

    Attributes
    ----------
    distance : float
        The largest distance, clip units, of a joint from where it should be.
    frame, joint : int, str
        Where that is.
    skipped : int
        Frames left out because a joint is at gimbal lock and bvhio's result is another one there.
    tolerance : float
        The distance that is allowed, clip units.
    """

    distance: float
    frame: int
    joint: str
    skipped: int
    tolerance: float

    @property
    def ok(self) -> bool:
        """Whether no compared joint is farther off than the tolerance."""
        return self.distance <= self.tolerance


def to_bvhio(motion: Motion) -> Any:  # noqa: ANN401 (bvhio has no types)
    """Return the motion as a `bvhio.BvhContainer`, in single precision; of several End Sites the last."""
    bvhio, glm = _bvhio_and_glm()
    skeleton = motion.skeleton
    nodes: list[Any] = []
    for j, name in enumerate(skeleton.names):
        node = bvhio.BvhJoint(name, glm.vec3(*skeleton.offsets[j].tolist()))
        node.Channels = list(skeleton.channels[j])
        positions = np.repeat(skeleton.offsets[j][None], len(motion), axis=0)
        if skeleton.translation_places[j] >= 0:
            positions = motion.translations[:, skeleton.translation_places[j]]
        node.Keyframes = [
            bvhio.Pose(glm.vec3(*position), glm.quat(*turn))
            for position, turn in zip(positions.tolist(), motion.rotations[:, j].tolist(), strict=True)
        ]
        if skeleton.parents[j] >= 0:
            nodes[skeleton.parents[j]].Children.append(node)
        nodes.append(node)
    for site in skeleton.end_sites:
        nodes[site.joint].EndSite = glm.vec3(*site.offset.tolist())
    return bvhio.BvhContainer(nodes[0], len(motion), motion.frame_time)


def from_bvhio(container: Any) -> Motion:  # noqa: ANN401 (bvhio has no types)
    """Return the motion in a `bvhio.BvhContainer`; leaves get bvhio's End Site, which it always has."""
    nodes: list[Any] = []
    parents: list[int] = []
    stack = [(container.Root, -1)]
    while stack:
        node, parent = stack.pop()
        stack += [(child, len(nodes)) for child in reversed(node.Children)]
        nodes.append(node)
        parents.append(parent)
    skeleton = Skeleton(
        names=tuple(node.Name for node in nodes),
        parents=frozen(np.array(parents, dtype=np.intp)),
        offsets=frozen(np.array([list(node.Offset) for node in nodes], dtype=np.float64)),
        channels=tuple(tuple(channel for channel in node.Channels if channel in _CHANNEL_NAMES) for node in nodes),
        end_sites=tuple(
            EndSite(j, frozen(np.array(list(node.EndSite), dtype=np.float64)))
            for j, node in enumerate(nodes)
            if not node.Children
        ),
    )
    rotations, translations = _keyframes(nodes)
    return Motion(
        skeleton,
        frozen(rotations),
        frozen(translations[:, skeleton.translated]),
        float(container.FrameTime),
    )


def check_with_bvhio(data: bytes, motion: Motion, *, leg_length: float) -> VerifyResult:
    """Return how far the joints of written bytes, read by bvhio, are from the motion that was to be written.

    Parameters
    ----------
    data : bytes
        A BVH file.
    motion : Motion
        What it should hold: a skeleton with the same joints, the same number of frames.
    leg_length : float
        Clip units; the tolerance is `VERIFY_TOLERANCE` times this.

    Raises
    ------
    BvhError
        Where this package's own reader refuses the bytes, or the frame counts differ.
    """
    clip = parse_clip(data, label="the written file", lenient=True)
    if len(clip.motion) != len(motion):
        message = f"the written file has {len(clip.motion)} frames, the motion {len(motion)}"
        raise BvhError(message)
    rotations, translations = _read_by_bvhio(clip)
    skeleton = motion.skeleton
    everywhere = Skeleton(
        names=skeleton.names,
        parents=skeleton.parents,
        offsets=skeleton.offsets,
        channels=(("Xposition", "Yposition", "Zposition"),) * len(skeleton),
    )
    theirs = forward(Motion(everywhere, rotations, translations, motion.frame_time)).positions
    distances = np.linalg.norm(theirs - forward(motion).positions, axis=-1)
    tolerance = VERIFY_TOLERANCE * leg_length
    # Written so that a distance that is no number counts as off.
    off = ~(distances.max(axis=1) <= tolerance)
    skipped = off & _locked_frames(motion)
    distances[skipped] = 0.0
    frame, joint = np.unravel_index(int(np.argmax(distances)), distances.shape)
    return VerifyResult(
        distance=float(distances[frame, joint]),
        frame=int(frame),
        joint=skeleton.names[int(joint)],
        skipped=int(np.count_nonzero(skipped)),
        tolerance=tolerance,
    )


def _read_by_bvhio(clip: Clip) -> tuple[FloatArray, FloatArray]:
    """Return bvhio's local rotations (F, J, 4) and translations (F, J, 3) of a clip's own bytes.

    bvhio reads a part of what is legal: no BOM, no brace on a name's line, keywords and channels only in their usual
    spelling. What it refuses is given to it once more, with the same rows under a plainly written hierarchy.
    """
    if not clip.warnings:
        try:
            nodes = _nodes_of(clip.text.data)
        except Exception:  # noqa: BLE001, S110 (whatever bvhio raises, the plain form comes next)
            pass
        else:
            if [tuple(node.Channels) for node in nodes] == list(clip.motion.skeleton.channels):
                return _keyframes(nodes)
    try:
        return _keyframes(_nodes_of(_plain_bytes(clip)))
    except RecursionError as error:
        message = f"bvhio cannot follow {len(clip.motion.skeleton.levels)} joints nested in each other"
        raise BvhError(message) from error


def _plain_bytes(clip: Clip) -> bytes:
    """Return the clip's rows, as they stand, under a hierarchy written the way bvhio likes it."""
    skeleton, rows = clip.motion.skeleton, clip.text.rows
    plain = Skeleton(
        names=tuple(f"joint{j}" for j in range(len(skeleton))),
        parents=skeleton.parents,
        offsets=skeleton.offsets,
        channels=skeleton.channels,
    )
    lines = [*hierarchy_lines(plain, 9), "MOTION", f"Frames: {len(rows.starts)}"]
    lines.append(f"Frame Time: {plain_number(clip.motion.frame_time)}")
    spans = zip(rows.starts.tolist(), rows.stops.tolist(), strict=True)
    lines += [clip.text.data[start:stop].decode("ascii") for start, stop in spans]
    return "".join(f"{line}\n" for line in lines).encode()


def _bvhio_and_glm() -> tuple[Any, Any]:
    with warnings.catch_warnings():
        # bvhio imports its vector library by a name that the library is about to give up.
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        import bvhio
        import glm
    return bvhio, glm


def _nodes_of(data: bytes) -> list[Any]:
    import tempfile

    bvhio, _ = _bvhio_and_glm()
    with tempfile.TemporaryDirectory(prefix="motionedit-") as folder:
        path = Path(folder) / "clip.bvh"
        path.write_bytes(data)
        return [node for node, _, _ in bvhio.readAsBvh(str(path)).Root.layout()]


def _keyframes(nodes: Sequence[Any]) -> tuple[FloatArray, FloatArray]:
    """Return the rotations (F, J, 4) and translations (F, J, 3) of bvhio's joints."""
    frames = len(nodes[0].Keyframes)
    rotations = np.empty((frames, len(nodes), 4))
    translations = np.empty((frames, len(nodes), 3))
    for j, node in enumerate(nodes):
        turns = [pose.Rotation for pose in node.Keyframes]
        rotations[:, j] = [(q.w, q.x, q.y, q.z) for q in turns]
        translations[:, j] = [tuple(pose.Position) for pose in node.Keyframes]
    return normalize(rotations), translations


def _locked_frames(motion: Motion) -> BoolArray:
    """Return the frames at which a joint with three rotation channels is at gimbal lock, shape (F,)."""
    locked = np.zeros(len(motion), dtype=np.bool_)
    for j, axes in enumerate(motion.skeleton.rotation_axes):
        if len(axes) == 3:
            middle = solve_angles(motion.rotations[:, j].T, axes)[1]
            locked |= np.abs(middle) > np.pi / 2.0 - _LOCK_BAND
    return locked
