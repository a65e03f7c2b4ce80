"""A skeleton as a robot description that other solvers read: MJCF, with a free joint and ball joints."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.skeleton import Skeleton

# Kilograms of a joint that carries no mass: simulators refuse a moving body without any.
LEAST_MASS = 1e-9
# Kilograms times metres squared, of every body: kinematics does not look at it, but simulators want some.
INERTIA = 1e-6


def mjcf(skeleton: Skeleton, masses: Masses) -> str:
    """Return the skeleton as MJCF: a free joint at the root, ball joints below, one body by joint."""
    top = ET.Element("mujoco", model="skeleton")
    # Turns are by radians, gravity is of no matter, and light bodies shall stay as light as they are.
    ET.SubElement(top, "compiler", angle="radian", autolimits="false")
    bodies = [ET.SubElement(top, "worldbody")]
    for j, name in enumerate(skeleton.names):
        parent = bodies[skeleton.parents[j] + 1]
        place = np.zeros(3) if j == 0 else skeleton.offsets[j]
        body = ET.SubElement(parent, "body", name=name, pos=_numbers(place))
        kind = {"type": "free"} if j == 0 else {"type": "ball", "pos": "0 0 0"}
        ET.SubElement(body, "joint", {"name": f"{name}_joint", **kind})
        mass = max(float(masses.shares[j]), LEAST_MASS)
        ET.SubElement(
            body,
            "inertial",
            pos=_numbers(masses.points[j]),
            mass=repr(mass),
            diaginertia=_numbers([INERTIA] * 3),
        )
        bodies.append(body)
    return ET.tostring(top, encoding="unicode")


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    """Return numbers with all their digits, separated by blanks."""
    return " ".join(repr(float(value)) for value in values)
