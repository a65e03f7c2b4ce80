"""The spec of fit-pca: how the motion PCA model is made, [PC] 4.1."""

from typing import Annotated, Literal

from pydantic import Field

from motionedit.spec import kinds
from motionedit.spec.document import Document


class FitPcaSpec(Document):
    """Everything fit-pca is told."""

    at_most_one = (("components", "explained_variance"),)

    schema_id: Annotated[str, kinds.schema_id("fit-pca")] = Field(
        default="motionedit/fit-pca/v1", alias="schema", description="Which spec this is."
    )
    components: Annotated[int | None, kinds.whole(at_least=1)] = Field(
        default=None,
        description="How many principal components are kept; default: all of rank, of more than 2,000 clips the first "
        "100.",
    )
    explained_variance: Annotated[float | None, kinds.number(above=0.0, at_most=1.0)] = Field(
        default=None,
        description="Keep as many components as explain this share of the variance (sigma, eq. 4), 0 to 1.",
    )
    rotation: Annotated[Literal["centred", "exponential"], kinds.word("centred", "exponential")] = Field(
        default="centred",
        description="How rotations become vectors: centred on each joint's mean, or the paper's exponential map.",
    )
    root_weight: Annotated[float, kinds.number(above=0.0)] = Field(
        default=1.0, description="Weight of the root's position against rotations (metres against radians)."
    )
    exclude_joints: Annotated[tuple[str, ...], kinds.JOINTS_OR_NONE] = Field(
        default=(), description="Joints left out of the model; they are copied through."
    )
