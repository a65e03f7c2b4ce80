"""What a spec of fit-pca asks of clips: how many components they make, and which joints a model leaves out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.pca.streaming import MOST_COMPONENTS
from motionedit.errors import ModelError
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from motionedit.core.skeleton import Skeleton
    from motionedit.errors import MotionEditError
    from motionedit.spec.fit_pca import FitPcaSpec
    from motionedit.spec.load import LoadedSpec


def excluded_joints(
    loaded: LoadedSpec[FitPcaSpec] | None, skeleton: Skeleton, label: str, *, travel: int
) -> frozenset[int]:
    """Return the joints that a spec leaves out of the model of a motion, which messages call `label`.

    `travel` is the joint whose path is the body's.

    Raises
    ------
    SpecError, MotionEditErrors
        There is no such joint, or it carries the travel.
    """
    if loaded is None:
        return frozenset()
    place = resolve.Place(loaded, ("exclude_joints",), label)
    found = resolve.joints(loaded.model.exclude_joints, skeleton, place)
    if travel in found:
        name = skeleton.names[travel]
        message = f"in {label}: '{name}' carries the travel, which a model always has; leave it off the list"
        raise place.at(found.index(travel)).error(message)
    return frozenset(found)


def refuse_too_many_components(loaded: LoadedSpec[FitPcaSpec], clips: int) -> None:
    """Raise a SpecError where a spec asks for more components than so many clips can have."""
    asked = loaded.model.components
    if asked is not None and asked >= clips:
        raise too_few_components(loaded, loaded.model, clips, clips - 1)


def too_few_components(
    loaded: LoadedSpec[FitPcaSpec] | None, spec: FitPcaSpec, clips: int, available: int
) -> MotionEditError:
    """Return the error of more components than there are."""
    message = f"{clips} clips have {available} components, not {spec.components}"
    if available == MOST_COMPONENTS:
        message = f"of {clips} clips at most {available} components are kept, not {spec.components}"
    return ModelError(message) if loaded is None else loaded.error(("components",), message)
