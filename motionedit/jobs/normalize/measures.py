"""What normalize takes from each clip before it knows the means, and whether clips belong together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.ground import axis_name
from motionedit.core.skeleton_match import match_joints
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError, MotionEditError
from motionedit.jobs.batch.held import hold
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.crop import cropped
from motionedit.jobs.clip.events import events_at_edge, explicit_events, found_events
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.unit import unit_doubts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.body.ground import Frame
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.clip.facts import ClipFacts, Line
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.normalize import NormalizeSpec


@dataclass(frozen=True, eq=False)
class ClipMeasure:
    """What the first phase takes from a clip.

    `first` and `last` are the frames that count, after a rest pose and within the spec's crop; `travel` is the joint
    that carries the travel; `stands` says whether both feet stand side by side where clips are aligned, `lines` by what
    they may be.
    """

    label: str
    clip: str
    digest: str
    frames: int
    frame_time: float
    first: int
    last: int
    events: dict[str, float]
    skeleton: Skeleton
    up: str
    height: float
    travel: int
    stands: bool
    lines: dict[Line, Frame]
    warnings: tuple[str, ...]

    @property
    def duration(self) -> float:
        """Seconds from the first frame that counts to the last."""
        return (self.last - self.first) * self.frame_time


@dataclass(frozen=True)
class MeasureClip:
    """The first phase of normalize, on one clip.

    `others` are all clips of the run, as event files call them; of motions so many bytes are held for the second phase.
    """

    loaded: LoadedSpec[NormalizeSpec]
    lenient: bool
    others: tuple[str, ...]
    held: int = 0

    def __call__(self, task: ClipTask) -> ClipMeasure:
        """Return the clip's measure."""
        spec = self.loaded.model
        clip = read_task(task, lenient=self.lenient)
        digest = clip.sha256  # while the processor has the bytes at hand
        hold(task, clip, most=self.held)
        given = resolve.body(spec.body, clip.motion.skeleton, resolve.Place(self.loaded, ("body",), task.label))
        facts = facts_of(clip, up=spec.up, keep_rest_pose=spec.rest_pose == "keep", given=given)
        facts.refuse_one_frame()
        events, warnings = _events(self.loaded, task, facts, self.others)
        place = resolve.Place(self.loaded, (), task.label)
        first, last = cropped(spec.crop, facts, place, events=events)
        at = (None if first == facts.first else float(first)) if spec.align_event is None else events[spec.align_event]
        lines: dict[Line, Frame] = {"hips": facts.line_frame("hips", at), "feet": facts.line_frame("feet", at)}
        return ClipMeasure(
            label=task.label,
            clip=task.relative,
            digest=digest,
            frames=len(clip.motion),
            frame_time=clip.motion.frame_time,
            first=first,
            last=last,
            events=events,
            skeleton=clip.motion.skeleton,
            up=axis_name(facts.up),
            height=facts.anatomy.height,
            travel=facts.travel,
            stands=facts.stands(at),
            lines=lines,
            warnings=(*facts.warnings, *unit_doubts(facts.anatomy.leg_length, spec.unit), *warnings),
        )


def _events(
    loaded: LoadedSpec[NormalizeSpec],
    task: ClipTask,
    facts: ClipFacts,
    others: Sequence[str],
) -> tuple[dict[str, float], list[str]]:
    """Return the frames of all events of a clip, and what is odd about them."""
    known = explicit_events(loaded, facts.clip, relative=task.relative, others=others)
    place = resolve.Place(loaded, ("events",), task.label)
    found = found_events(loaded.model.events, facts, place, known=known)
    for name in loaded.model.events:
        if name not in found.frames:
            raise place.at(name).error(f"no frame for {task.label}; add it to frames, or give detect")
    return found.frames, events_at_edge(found)


def sound_measures(
    tasks: Sequence[ClipTask], measured: Sequence[ClipMeasure | MotionEditError]
) -> tuple[list[ClipMeasure], dict[str, MotionEditError]]:
    """Return the clips that can be used together, and why the others cannot; the first good clip is the measure."""
    sound: list[ClipMeasure] = []
    failures: dict[str, MotionEditError] = {}
    for task, value in zip(tasks, measured, strict=True):
        if isinstance(value, MotionEditError):
            failures[task.label] = value
            continue
        try:
            _check_against(sound[0] if sound else value, value)
            sound.append(value)
        except ClipError as error:
            failures[task.label] = error
    return sound, failures


def _check_against(first: ClipMeasure, other: ClipMeasure) -> None:
    match_joints(first.skeleton, other.skeleton, height=first.height, label=other.label, against=first.label)
    if other.up != first.up:
        message = f"its up axis is {other.up}, that of {first.label} is {first.up}; turn the file, or set up:"
        raise ClipError(message, file=other.label)
