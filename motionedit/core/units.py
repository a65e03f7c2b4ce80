"""What a length and an angle count as inside the core: bodies of all sizes are brought to one."""

# Metres: the leg length that every body is scaled to before it is solved. "Metres" in a solver are those.
STANDARD_LEG = 0.85
# One radian of orientation weighs as much as this many metres at that leg length.
METRES_PER_RADIAN = 0.3
