"""The spec of fit-pca: how the motion PCA model is made, [PC] 4.1."""

from typing import Literal

from motionedit.spec import kinds
from motionedit.spec.document import Document
from motionedit.spec.model import spec_key


class FitPcaSpec(Document):
    """Everything fit-pca is told."""

    at_most_one = (("components", "explained_variance"),)

    schema_id: str = spec_key(
        kinds.schema_id("fit-pca"), default="motionedit/fit-pca/v1", name="schema", description="Which spec this is."
    )
    components: int | None = spec_key(
        kinds.components(),
        default=None,
        description="How many principal components are kept; default: all of rank, of more than 2,000 clips the first "
        "100.",
    )
    explained_variance: float | None = spec_key(
        kinds.number(above=0.0, at_most=1.0),
        default=None,
        description="Keep as many components as explain this share of the variance (sigma, eq. 4), 0 to 1.",
    )
    rotation: Literal["centred", "exponential"] = spec_key(
        kinds.word("centred", "exponential"),
        default="centred",
        description="How rotations become vectors: centred on each joint's mean, or the paper's exponential map.",
    )
    root_weight: float = spec_key(
        kinds.number(above=0.0),
        default=1.0,
        description="Weight of the root's position against rotations (metres against radians).",
    )
    exclude_joints: tuple[str, ...] = spec_key(
        kinds.JOINTS_OR_NONE,
        default=(),
        description="Joints left out of the model, but for the one that carries the travel; edits copy them through, "
        "and turn no leg or arm with one of them for feet that stand and hands that hold.",
    )
