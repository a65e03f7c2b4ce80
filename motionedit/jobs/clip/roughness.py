"""Whether a viewer would see an edit whose goals are met: joints that step, jerk, joints beyond their range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.bent_back import bent_back
from motionedit.core.body.quality import STILL
from motionedit.core.body.ranges import beyond_range, regions_of
from motionedit.core.body.snaps import snaps
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray
    from motionedit.core.body.bends import Bend
    from motionedit.core.body.ranges import Beyond
    from motionedit.core.body.steps import Steps
    from motionedit.core.body.trace import Trace
    from motionedit.core.motion import Motion
    from motionedit.jobs.clip.facts import ClipFacts

# Degrees in a sixtieth of a second by which a joint's change steps where a viewer sees it.
_STEP = 10.0
# Times the input's jerk that a viewer sees.
_JERK = 2.0


def rough_lines(
    facts: ClipFacts,
    after: Motion,
    *,
    touched: BoolArray,
    steps: Steps,
    traces: tuple[Trace, Trace],
    bends: Sequence[Bend] = (),
) -> list[str]:
    """Return why a viewer would see an edit, a line for each rule that it breaks, with joint and frame; none: nothing.

    Parameters
    ----------
    after : Motion
        The edited motion; its translations are those of its own skeleton, in whichever unit.
    touched : shape (J,)
        The joints that it turned.
    steps : Steps
        Of the change that it made.
    traces : (before, after)
        By `feet_of`.
    bends : sequence of Bend
        To which side knees and elbows bend.
    """
    lines = [_stepping(facts, steps), _jerk(facts, *traces), *_beyond(facts, after, bends, touched)]
    return [line for line in lines if line is not None]


def snap_line(facts: ClipFacts, after: Motion, *, touched: BoolArray) -> str | None:
    """Return the knee or elbow that an edit snaps the most, as a multiple of what would be seen; None where none does.

    Of edits by goals at single frames: where a constraint holds a limb, or lets it go, its user says how suddenly.
    """
    found = snaps(after, facts.bends, first=facts.first, touched=touched)
    if not found:
        return None
    worst = max(found, key=lambda one: one.degrees / one.most)
    return (
        f"{facts.clip.motion.skeleton.names[worst.joint]}: snaps at frame {worst.frame}: within a sixtieth of a second "
        f"its bending changes by {worst.degrees:.3g} degrees ({worst.most:.3g} would be seen){_others(len(found))}"
    )


def _stepping(facts: ClipFacts, steps: Steps) -> str | None:
    """Return the joint whose change steps the most, beyond what is seen and what the joint itself does in the input."""
    limits = np.maximum(_STEP, facts.steps.degrees)
    seen = np.flatnonzero(steps.degrees > limits)
    if not len(seen):
        return None
    worst = int(seen[np.argmax(steps.degrees[seen])])
    return (
        f"{facts.clip.motion.skeleton.names[worst]}: its change steps by {steps.degrees[worst]:.3g} degrees in a "
        f"sixtieth of a second at frame {steps.frames[worst]} ({limits[worst]:.3g} would be seen){_others(len(seen))}"
    )


def _jerk(facts: ClipFacts, before: Trace, after: Trace) -> str | None:
    still = STILL * facts.anatomy.leg_length / STANDARD_LEG
    times = after.jerk_rms / max(before.jerk_rms, still) if still > 0.0 else 0.0
    if times <= _JERK:
        return None
    joint, frame = after.jerk_at
    name = facts.clip.motion.skeleton.names[joint]
    least = "the input's" if before.jerk_rms >= still else f"the least that counts, {STILL:g} m/s^3 at a leg of 0.85 m"
    return f"{name}: jerks at frame {frame}; the body's jerk is {times:.3g} times {least} ({_JERK:g} would be seen)"


def _beyond(facts: ClipFacts, after: Motion, bends: Sequence[Bend], touched: BoolArray) -> list[str]:
    before, anatomy, first = facts.clip.motion, facts.anatomy, facts.first
    regions = regions_of(before.skeleton, anatomy, travel=facts.travel)
    turned = beyond_range(before, after, regions, first=first, touched=touched)
    back = bent_back(before, after, anatomy, bends, first=first, touched=touched)
    return [_beyond_line(facts, found) for found in (turned, back) if found]


def _beyond_line(facts: ClipFacts, found: Sequence[Beyond]) -> str:
    """Return the worst of what is beyond its range, as a multiple of what would be seen."""
    worst = max(found, key=lambda one: one.degrees / one.most)
    names = facts.clip.motion.skeleton.names
    how = "bent back" if worst.against is None else "turned"
    against = "" if worst.against is None else f" against {names[worst.against]}"
    return (
        f"{names[worst.joint]}: {how} by {worst.degrees:.3g} degrees beyond its range in the input{against} at frame "
        f"{worst.frame} ({worst.most:g} would be seen){_others(len({one.joint for one in found}))}"
    )


def _others(count: int) -> str:
    return f", and {count - 1} more joint{'s' if count > 2 else ''}" if count > 1 else ""
