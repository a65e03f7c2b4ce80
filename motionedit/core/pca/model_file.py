"""The model file: one .npz without pickles, the same bytes for the same model."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.pca.array_file import array_bytes, read_arrays
from motionedit.core.pca.coordinates import PoseSpace
from motionedit.core.pca.fit import PrincipalComponents
from motionedit.core.pca.left_out import LeftOut
from motionedit.core.pca.model import DatabaseClip, MotionModel
from motionedit.core.plain_values import BEYOND_SENSE, items, json_of, mapping, number, positive, text, whole
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.core.timeline.warp import Timeline
from motionedit.errors import ModelError
from motionedit.regular_files import read_file

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray

FORMAT = "motionedit/model/v1"

_ARRAYS = (
    *("about", "parents", "offsets", "end_site_joints", "end_site_offsets", "space_joints", "references", "up"),
    *("mean", "components", "explained_variance", "coefficients"),
)
# Files that were written before these were kept have none of them.
_LEFT_OUT = ("left_out_deviations", "left_out_residuals")
_CHANNELS = {f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
# What a unit length, or a sum of shares, may be off.
_ROUNDING = 1e-6


def model_bytes(model: MotionModel) -> bytes:
    """Return the file of a model."""
    skeleton, space, pca = model.skeleton, model.space, model.components
    about = {
        "format": FORMAT,
        "joints": skeleton.names,
        "channels": skeleton.channels,
        "frames": model.timeline.frames,
        "frame_rate": model.timeline.frame_rate,
        "events": model.timeline.events,
        "travel": model.travel,
        "scale": space.scale,
        "root_weight": space.root_weight,
        "total_variance": pca.total_variance,
        "clips": [{"name": clip.name, "sha256": clip.digest, "events": clip.events} for clip in model.clips],
        "rules": model.rules,
    }
    said = json.dumps(about, ensure_ascii=False, allow_nan=False)
    arrays: dict[str, NDArray[Any]] = {
        "about": np.frombuffer(said.encode(), dtype=np.uint8),
        "parents": skeleton.parents.astype(np.int64),
        "offsets": skeleton.offsets,
        "end_site_joints": np.array([site.joint for site in skeleton.end_sites], dtype=np.int64),
        "end_site_offsets": np.array([site.offset for site in skeleton.end_sites]).reshape(-1, 3),
        "space_joints": space.joints.astype(np.int64),
        "references": space.references,
        "up": model.up,
        "mean": pca.mean,
        "components": pca.components,
        "explained_variance": pca.explained_variance,
        "coefficients": pca.coefficients,
    }
    if pca.left_out is not None:
        arrays |= dict(zip(_LEFT_OUT, (pca.left_out.deviations, pca.left_out.residuals), strict=True))
    return array_bytes(arrays)


def read_model(path: Path) -> MotionModel:
    """Return the model of a file.

    Raises
    ------
    ModelError
        If it cannot be read, or is no model of a format this version knows.
    """
    label = str(path)
    try:
        arrays = read_arrays(read_file(path), names=_ARRAYS, more=_LEFT_OUT)
    except OSError as error:
        raise ModelError(f"cannot be read: {error.strerror or error}", file=label) from error
    except ValueError as error:
        raise ModelError(f"not a model file: {error}; make one with 'motionedit fit-pca'", file=label) from error
    try:
        return _model_of(arrays, label=label)
    except (KeyError, ValueError) as error:
        raise ModelError("damaged, or not a model file; make it again with 'motionedit fit-pca'", file=label) from error


def _model_of(arrays: Mapping[str, NDArray[Any]], *, label: str) -> MotionModel:
    about = mapping(json_of(arrays["about"].tobytes()))
    if about["format"] != FORMAT:
        message = (
            f"has format '{about['format']}', this version reads '{FORMAT}'; make it again with 'motionedit fit-pca'"
        )
        raise ModelError(message, file=label)
    skeleton = _skeleton_of(arrays, about)
    timeline = _timeline_of(about)
    joints = _indices(arrays["space_joints"], below=len(skeleton))
    space = PoseSpace(
        joints=joints,
        references=_numbers(arrays["references"], (len(joints), 4)),
        scale=positive(about["scale"]),
        root_weight=positive(about["root_weight"]),
    )
    if len(set(joints.tolist())) < len(joints) or not _of_unit_length(space.references):
        raise ValueError("no pose space")
    clips = tuple(_clip_of(mapping(clip)) for clip in items(about["clips"]))
    components = _components_of(arrays, about, size=timeline.frames * space.size, clips=len(clips))
    up = _numbers(arrays["up"], (3,))
    if sorted(map(abs, up.tolist())) != [0.0, 0.0, 1.0]:
        raise ValueError("no axis")
    rules = mapping(about["rules"])  # whoever needs one of them checks them: see checked_rules
    travel = whole(about["travel"], 0, len(skeleton) - 1)
    return MotionModel(skeleton, space, timeline, travel, up, components, clips, rules)


def _skeleton_of(arrays: Mapping[str, NDArray[Any]], about: Mapping[str, Any]) -> Skeleton:
    names = tuple(map(text, items(about["joints"])))
    channels = tuple(tuple(map(text, items(each))) for each in items(about["channels"]))
    parents = arrays["parents"]
    site_joints = _indices(arrays["end_site_joints"], below=len(names))
    site_offsets = _numbers(arrays["end_site_offsets"], (len(site_joints), 3))
    # A joint stands after its parent, and the first has none.
    if not names or len(channels) != len(names) or parents.shape != (len(names),) or parents.dtype != np.int64:
        raise ValueError("no skeleton")
    if parents[0] != -1 or (parents[1:] < 0).any() or (parents[1:] >= np.arange(1, len(names))).any():
        raise ValueError("no tree of joints")
    if any(len(set(each)) < len(each) or not set(each) <= _CHANNELS for each in channels):
        raise ValueError("no channels")
    return Skeleton(
        names=names,
        parents=frozen(parents.astype(np.intp)),
        offsets=_numbers(arrays["offsets"], (len(names), 3)),
        channels=channels,
        end_sites=tuple(
            EndSite(int(joint), frozen(offset)) for joint, offset in zip(site_joints, site_offsets, strict=True)
        ),
    )


def _timeline_of(about: Mapping[str, Any]) -> Timeline:
    frames = whole(about["frames"], 2)
    events = [items(each) for each in items(about["events"])]
    places = {text(name): whole(frame, 0, frames - 1) for name, frame in events}
    order = list(places.values())
    # The first and the last frame are none of an event, and two events have two frames.
    if len(places) < len(events) or order != sorted(set(order)) or not {0, frames - 1}.isdisjoint(order):
        raise ValueError("no timeline")
    return Timeline(frames, positive(about["frame_rate"]), tuple(places.items()))


def _clip_of(clip: Mapping[str, Any]) -> DatabaseClip:
    events = [items(each) for each in items(clip["events"])]
    return DatabaseClip(
        text(clip["name"]), text(clip["sha256"]), tuple((text(name), number(frame, 0.0)) for name, frame in events)
    )


def _components_of(
    arrays: Mapping[str, NDArray[Any]], about: Mapping[str, Any], *, size: int, clips: int
) -> PrincipalComponents:
    count = len(arrays["explained_variance"]) if arrays["explained_variance"].ndim == 1 else 0
    found = PrincipalComponents(
        mean=_numbers(arrays["mean"], (size,)),
        components=_numbers(arrays["components"], (count, size)),
        explained_variance=_numbers(arrays["explained_variance"], (count,)),
        total_variance=positive(about["total_variance"]),
        coefficients=_numbers(arrays["coefficients"], (clips, count)),
        left_out=_left_out_of(arrays, clips=clips),
    )
    variance = found.explained_variance
    # Each divides by its root, and all are shares of the total.
    if not count or clips < 2 or not variance.min() > 0.0 or not (np.diff(variance) <= 0.0).all():
        raise ValueError("no components")
    if variance.sum() > found.total_variance * (1.0 + _ROUNDING) or not _of_unit_length(found.components):
        raise ValueError("no components")
    return found


def _numbers(array: NDArray[Any], shape: tuple[int, ...]) -> FloatArray:
    """Return an array of numbers of this shape that are finite, and none beyond sense."""
    if array.dtype != np.float64 or array.shape != shape or not (np.abs(array) <= BEYOND_SENSE).all():
        raise ValueError("not the numbers that belong there")
    return frozen(array)


def _indices(array: NDArray[Any], *, below: int) -> IntArray:
    if array.dtype != np.int64 or array.ndim != 1 or (array < 0).any() or (array >= below).any():
        raise ValueError("not the joints that belong there")
    return frozen(array.astype(np.intp))


def _of_unit_length(rows: FloatArray) -> bool:
    return bool((np.abs(np.linalg.norm(rows, axis=1) - 1.0) <= _ROUNDING).all())


def _left_out_of(arrays: Mapping[str, NDArray[Any]], *, clips: int) -> LeftOut | None:
    """Return what leaving out did to the database; None of a file that was written before it was kept."""
    if not set(_LEFT_OUT) <= set(arrays):
        return None
    deviations, residuals = (_numbers(arrays[name], (clips,)) for name in _LEFT_OUT)
    if (deviations < 0.0).any() or (residuals < 0.0).any() or not deviations.sum() > 0.0:
        raise ValueError("no squares")
    return LeftOut(deviations, residuals)
