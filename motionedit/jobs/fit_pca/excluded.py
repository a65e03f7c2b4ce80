"""The joints that a spec of fit-pca leaves out of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.bones import travel_joint
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from motionedit.core.motion import Motion
    from motionedit.spec.fit_pca import FitPcaSpec
    from motionedit.spec.load import LoadedSpec


def excluded_joints(loaded: LoadedSpec[FitPcaSpec] | None, motion: Motion, label: str) -> frozenset[int]:
    """Return the joints that a spec leaves out of the model of a motion, which messages call `label`.

    Raises
    ------
    SpecError, MotionEditErrors
        There is no such joint, or it carries the travel.
    """
    if loaded is None:
        return frozenset()
    place = resolve.Place(loaded, ("exclude_joints",), label)
    found = resolve.joints(loaded.model.exclude_joints, motion.skeleton, place)
    travel = travel_joint(motion)
    if travel in found:
        name = motion.skeleton.names[travel]
        message = f"in {label}: '{name}' carries the travel, which a model always has; leave it off the list"
        raise place.at(found.index(travel)).error(message)
    return frozenset(found)
