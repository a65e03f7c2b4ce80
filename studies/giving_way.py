"""Draw the pictures of docs/giving-way.md anew: `python -m studies.giving_way`, or `make pictures`."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.bends import turns_about
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from motionedit.core.rotations import angle_between, rotate
from studies.lab import Lab
from studies.paper.drawing import BLUE, GREEN, GREY, ORANGE, PALE, QUIET, new_figure, png_bytes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray

ROOT = Path(__file__).resolve().parents[1]
WALK = ROOT / "data" / "walk.bvh"
DEFAULT: dict[str, Any] = {}
PAPER: dict[str, Any] = {"smoothing": {"method": "paper"}, "stiffness": "none", "limits": "off", "hinges": "off"}
Points = list[dict[str, Any]]
STANDING: Points = [
    {"type": "position", "effector": ["LeftFoot", "RightFoot", "LeftToeBase", "RightToeBase"], "priority": 10},
    {"type": "com", "axes": ["x", "z"], "relative_to": "world", "priority": 2},
]


def main() -> None:
    """Write the pictures."""
    with tempfile.TemporaryDirectory() as scratch:
        lab = Lab(Path(scratch))
        for name, figure in {"giving-way": smooth(lab), "believable": believable(lab)}.items():
            (ROOT / "docs" / "images" / f"{name}.png").write_bytes(png_bytes(figure))


def smooth(lab: Lab) -> Figure:
    """Return how an elbow bends whose hand is out of reach, and how high a hand goes where constraints switch."""
    figure = new_figure(9.6, 3.4)
    left, right = figure.subplots(1, 2)
    far = [*STANDING, hand(5, [{"at": 72, "shift": [100, 200, 100]}], ease=0.5)]
    switched = [hand(1, [{"hold": [30, 100], "shift": [0, 45, 0]}]), hand(5, [{"hold": [60, 70], "shift": [0, 20, 0]}])]
    left.plot(bend(WALK), color=GREY, label="input")
    right.plot(height(WALK), color=GREY, label="input")
    for label, color, keys in (("as the paper", BLUE, PAPER), ("default", ORANGE, DEFAULT)):
        left.plot(bend(edited(lab, far, keys)), color=color, label=label)
        right.plot(height(edited(lab, switched, keys)), color=color, label=label)
    named(left, "A hand far out of reach", "the elbow's bend (degrees)", (40, 105))
    named(
        right, "A constraint begins over another, and ends", "height of the hand (cm)", (20, 150), place="center right"
    )
    return figure


def believable(lab: Lab) -> Figure:
    """Return how an elbow bends without its hinge, and how a neck turns without stiffness and limits."""
    figure = new_figure(9.6, 3.4)
    left, right = figure.subplots(1, 2)
    across = [*STANDING, hand(5, [{"at": 72, "shift": [-100, 0, -40]}], ease=0.5)]
    high = [*STANDING, hand(5, [{"hold": [60, 85], "shift": [30, 110, 20]}], ease=0.5)]
    off, none = {"hinges": "off"}, {"stiffness": "none", "limits": "off"}
    left.axhspan(-12, 0, color=PALE, linewidth=0)
    left.text(42, -10.5, "bent back", color=QUIET)
    left.plot(bend(WALK), color=GREY, label="input")
    for label, color, keys in (("hinges: off", BLUE, off), ("default", ORANGE, DEFAULT)):
        left.plot(bend(edited(lab, across, keys)), color=color, label=label)
    named(left, "A hand across the body, and behind", "the elbow's bend (degrees)", (40, 105))
    plans = (("as the paper", BLUE, PAPER), ("stiffness: none, limits: off", GREEN, none), ("default", ORANGE, DEFAULT))
    for label, color, keys in plans:
        right.plot(turned(edited(lab, high, keys), "Neck"), color=color, label=label)
    named(
        right,
        "A hand reaches up: what the neck does",
        "the neck's turn from the input's (degrees)",
        (40, 145),
        place="center right",
    )
    return figure


def edited(lab: Lab, constraints: Points, keys: dict[str, Any]) -> Path:
    """Return the walk edited by constraints, in centimetres, and by further keys of the spec."""
    return lab.edit_prioritized(WALK, {"unit": "cm", "constraints": constraints, **keys}).path


def hand(priority: int, points: Points, *, ease: float = 0.25) -> dict[str, Any]:
    """Return a constraint of the left hand, eased in and out over some seconds."""
    eases = dict.fromkeys(("ease_in", "ease_out"), f"{ease}s")
    return {"type": "position", "effector": "LeftHand", "priority": priority, "points": points, **eases}


def named(axes: Axes, title: str, unit: str, frames: tuple[int, int], *, place: str = "best") -> None:
    """Name what a plot shows, over some frames."""
    axes.set(title=title, ylabel=unit, xlabel="frame", xlim=frames)
    axes.legend(loc=place)


def height(path: Path) -> FloatArray:
    """Return how high the left hand is at every frame of a file, shape (F,)."""
    motion = read_clip(path).motion
    found: FloatArray = forward(motion).positions[:, motion.skeleton.names.index("LeftHand"), 1]
    return found


def bend(path: Path) -> FloatArray:
    """Return how far the left elbow is bent about the axis that it bends about in the walk, degrees, shape (F,)."""
    motion, walk = read_clip(path).motion, read_clip(WALK).motion
    index = motion.skeleton.names.index
    fore, wrist = index("LeftForeArm"), index("LeftHand")
    upper, lower = (motion.skeleton.offsets[j] / np.linalg.norm(motion.skeleton.offsets[j]) for j in (fore, wrist))
    lowers = rotate(walk.rotations[:, fore], np.broadcast_to(lower, (len(walk), 3)))
    axis = np.cross(np.broadcast_to(upper, lowers.shape), lowers).sum(axis=0)
    lowers = rotate(motion.rotations[:, fore], np.broadcast_to(lower, (len(motion), 3)))
    return np.degrees(turns_about(axis / np.linalg.norm(axis), upper, lowers))


def turned(path: Path, joint: str) -> FloatArray:
    """Return by how much a joint is turned from the walk's, degrees, shape (F,)."""
    motion, walk = read_clip(path).motion, read_clip(WALK).motion
    j = motion.skeleton.names.index(joint)
    return np.degrees(angle_between(walk.rotations[:, j], motion.rotations[:, j]))


if __name__ == "__main__":
    main()
