"""The kinds of constraints, one file each; a new one is a file and its line here."""

from motionedit.core.priorities.kinds.aim import Aim
from motionedit.core.priorities.kinds.com import CenterOfMass
from motionedit.core.priorities.kinds.constraint import Constraint
from motionedit.core.priorities.kinds.distance import Distance
from motionedit.core.priorities.kinds.floor import Floor
from motionedit.core.priorities.kinds.footplants import Footplants
from motionedit.core.priorities.kinds.orientation import Orientation
from motionedit.core.priorities.kinds.pose import Pose
from motionedit.core.priorities.kinds.position import Position
from motionedit.core.priorities.kinds.posture import Posture

# By their names in a spec.
KINDS: dict[str, type[Constraint]] = {
    kind.type: kind for kind in (Position, Orientation, Pose, CenterOfMass, Aim, Posture, Distance, Floor, Footplants)
}
