"""The constants of the layered solver, once for both: csrc gets them by their names (`Constants` in layered.h)."""

# Metres at leg length 0.85 m: a layer's error is clamped to this much per iteration.
LARGEST_ERROR = 0.6
# That of a layer that gives way: so far it pulls, and no farther, at what is out of reach.
LARGEST_SOFT_ERROR = 0.3
# Metres: the root is drawn back by at most this much, or what asks it to be far away would not be met.
LARGEST_WAY_BACK = 0.3
# Radians: no joint turns further than this in one iteration. The series of csrc's q_exp are good up to it.
LARGEST_TURN = 0.5
# Radians and metres: a frame is done when its largest step falls below,
STOP_STEP = 1e-4
# or when the steps to come, by the ratio of the last two, add up to less than this, and the layers are met to that.
STOP_LEFT, STOP_ERROR = 2e-5, 1e-5
# Steps that shrink by a larger ratio promise nothing.
LARGEST_RATIO = 0.5
# The gain of the attraction: 1 at first, then this factor per iteration.
FULL_GAIN_ITERATIONS = 8
GAIN_DECAY = 0.85
# After so many iterations what is left may be out of reach, and steps are kept from swinging.
HASTY_ITERATIONS = 8
# Over so many last iterations the lower layers' largest error and the gain are quartered each time.
ANNEALED_ITERATIONS = 5
# That begins earlier where in so many steady iterations the length of an error, metres or radians at least, was this
# share of what it had been.
STALE_ITERATIONS, FAR_ERROR, SAME_ERROR = 3, 0.05, 0.98
# A hinge that leaves its limits is set on them and leaves the system; this many times at most.
LIMIT_ROUNDS = 4
# Radians: so far beyond its limit a hinge is on it.
ON_LIMIT = 1e-12
# One-sided rows are taken in so many times at most: the worst of each frame, the last time all.
SIDED_ROUNDS = 8
# Metres: a step that falls short of a row by less is on its limit.
ON_SIDE = 1e-12

# Radians: so far beyond its limit a joint has a frame solved on with limits,
BEYOND_LIMIT = 1e-6
# metres or radians: where nothing is farther from its goal, but what gives way. Out of reach is out of reach with them.
MET_WITHOUT_LIMITS = 1e-3

# A displacement below this (rad or m) is rounding: it is no displacement.
NO_DISPLACEMENT = 1e-9

# Metres, and sine: below these a direction is none.
NO_DIRECTION = 1e-9

# Singular values below this share of the layer's largest (or of the least scale) are no freedom.
RANK_TOLERANCE = 1e-4
LEAST_SCALE = 1e-2
# Metres at leg length 0.85 m: a stretched limb. A turn t of it takes its end t^2 / 2 of this off its tangent.
LIMB = 1.0

# The secant of the pull speaks of the pull alone: the step for the tasks must be shorter than this share of the others.
LARGEST_TASK_SHARE = 0.5
# An accelerated pull is at most so many times the plain one.
LARGEST_FACTOR = 3.0
# Squared length (rad, m) of a change of the pull that is rounding.
NO_CHANGE = 1e-24
