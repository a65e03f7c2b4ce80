"""Constraints in strict priority layers, from a spec to an edited clip and its report ([PRIO])."""
