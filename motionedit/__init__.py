"""Batch motion editing of BVH clips: motion principal coefficients [PC] and prioritized constraints [PRIO]."""

__version__ = "0.1.0"
