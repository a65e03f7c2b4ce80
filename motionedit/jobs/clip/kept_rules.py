"""Rules that a normalization, and so a model, has kept of the spec it was made by."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.dataclass import dataclass
from motionedit.errors import ClipError
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.body.anatomy import GivenBody
    from motionedit.core.skeleton import Skeleton
    from motionedit.errors import MotionEditError
    from motionedit.spec.body import BodySpec
    from motionedit.spec.document import Document
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True)
class KeptRules:
    """Kept rules as the place of an error, which names the file that they are in."""

    label: str

    def has(self, keys: Sequence[str | int]) -> bool:
        """Return that no line is known for any key."""
        del keys
        return False

    def error(self, keys: Sequence[str | int], message: str) -> MotionEditError:
        """Return an error of the clip, which the rule does not fit."""
        key = ".".join(map(str, keys))
        return ClipError(message, file=self.label, key=key)


def with_body(rules: dict[str, Any], spec: BodySpec) -> dict[str, Any]:
    """Return kept rules with what a spec says of the body in place of what they say of the same parts."""
    said, kept = spec.plain, rules.get("body", {})
    return {**rules, "body": {**kept, **said}} if said and isinstance(kept, dict) else rules


def body_said(
    loaded: LoadedSpec[Document], rules: dict[str, Any], skeleton: Skeleton, *, label: str, clip: str
) -> GivenBody:
    """Return what a spec says that a clip's joints are, and of what it does not say what kept rules say.

    Raises
    ------
    MotionEditError
        The clip lacks one of the joints: of the spec, or of the rules, which are in the file `label`.
    """
    said = loaded.model.body
    resolve.body(said, skeleton, resolve.Place(loaded, ("body",), clip))
    return kept_body(with_body(rules, said), skeleton, label=label, clip=clip)


def refuse_another_up(loaded: LoadedSpec[Document], up: str, *, by: str) -> None:
    """Raise a SpecError where a spec has another axis up than clips that were normalized, which `by` tells of."""
    said = loaded.model.up
    if said not in ("auto", up):
        raise loaded.error(("up",), f"the clips of {by} were normalized with {up} up, not {said}; leave it out")


def kept_body(rules: Mapping[str, Any], skeleton: Skeleton, *, label: str, clip: str) -> GivenBody:
    """Return what kept rules say that a clip's joints are; `label` is the file that they are in.

    Raises
    ------
    ClipError
        The clip lacks one of the joints.
    """
    from motionedit.spec.body import BodySpec

    try:
        spec = BodySpec.parse(rules.get("body", {}))
    except ValueError as error:
        raise ClipError(
            "its rules for the body are damaged; make it again with 'motionedit normalize'", file=label
        ) from error
    return resolve.body(spec, skeleton, resolve.Place(KeptRules(label), ("body",), clip))
