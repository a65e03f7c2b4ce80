"""The model file: one .npz without pickles, the same bytes for the same model."""

from __future__ import annotations

import io
import json
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.pca.coordinates import PoseSpace
from motionedit.core.pca.fit import PrincipalComponents
from motionedit.core.pca.left_out import LeftOut
from motionedit.core.pca.model import DatabaseClip, MotionModel
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.core.timeline.warp import Timeline
from motionedit.errors import ModelError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

FORMAT = "motionedit/model/v1"

# Zip entries carry a time; this one, the earliest that zip knows, keeps the bytes the same.
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)


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
    text = json.dumps(about, ensure_ascii=False, allow_nan=False)
    arrays: dict[str, NDArray[Any]] = {
        "about": np.frombuffer(text.encode(), dtype=np.uint8),
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
        arrays |= {"left_out_deviations": pca.left_out.deviations, "left_out_residuals": pca.left_out.residuals}
    return _npz(arrays)


def _npz(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            entry = io.BytesIO()
            np.lib.format.write_array(entry, np.ascontiguousarray(array), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", _ZIP_TIME), entry.getvalue())
    return buffer.getvalue()


def read_model(path: Path) -> MotionModel:
    """Return the model of a file.

    Raises
    ------
    ModelError
        If it cannot be read, or is no model of a format this version knows.
    """
    label = str(path)
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except OSError as error:
        raise ModelError(f"cannot be read: {error.strerror or error}", file=label) from error
    except (ValueError, TypeError, AttributeError, EOFError, KeyError, zipfile.BadZipFile) as error:
        raise ModelError("not a model file; make one with 'motionedit fit-pca'", file=label) from error
    try:
        return _model_of(arrays, label=label)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise ModelError("damaged, or not a model file; make it again with 'motionedit fit-pca'", file=label) from error


def _model_of(arrays: Mapping[str, NDArray[Any]], *, label: str) -> MotionModel:
    about = json.loads(arrays["about"].tobytes().decode())
    if about["format"] != FORMAT:
        message = (
            f"has format '{about['format']}', this version reads '{FORMAT}'; make it again with 'motionedit fit-pca'"
        )
        raise ModelError(message, file=label)
    sites = zip(arrays["end_site_joints"], arrays["end_site_offsets"], strict=True)
    skeleton = Skeleton(
        names=tuple(about["joints"]),
        parents=frozen(arrays["parents"].astype(np.intp)),
        offsets=frozen(arrays["offsets"]),
        channels=tuple(map(tuple, about["channels"])),
        end_sites=tuple(EndSite(int(joint), frozen(offset)) for joint, offset in sites),
    )
    space = PoseSpace(
        joints=frozen(arrays["space_joints"].astype(np.intp)),
        references=frozen(arrays["references"]),
        scale=about["scale"],
        root_weight=about["root_weight"],
    )
    components = PrincipalComponents(
        mean=frozen(arrays["mean"]),
        components=frozen(arrays["components"]),
        explained_variance=frozen(arrays["explained_variance"]),
        total_variance=about["total_variance"],
        coefficients=frozen(arrays["coefficients"]),
        left_out=_left_out_of(arrays),
    )
    if components.components.shape[1] != about["frames"] * space.size:
        raise ValueError("components and timeline disagree")
    timeline = Timeline(about["frames"], about["frame_rate"], tuple((name, frame) for name, frame in about["events"]))
    clips = tuple(
        DatabaseClip(clip["name"], clip["sha256"], tuple((name, frame) for name, frame in clip["events"]))
        for clip in about["clips"]
    )
    return MotionModel(
        skeleton, space, timeline, about["travel"], frozen(arrays["up"]), components, clips, about["rules"]
    )


def _left_out_of(arrays: Mapping[str, NDArray[Any]]) -> LeftOut | None:
    """Return what leaving out did to the database; None of a file that was written before it was kept."""
    if "left_out_residuals" not in arrays:
        return None
    return LeftOut(frozen(arrays["left_out_deviations"]), frozen(arrays["left_out_residuals"]))
