"""Inverse kinematics: in the space of the principal coefficients ([PC] 4.2), and in priority layers ([PRIO] 3)."""

# One radian of orientation weighs as much as this many metres at leg length 0.85 m.
METRES_PER_RADIAN = 0.3
