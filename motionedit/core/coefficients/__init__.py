"""Editing in the space of the principal coefficients: goals at one frame, solvers, the edit ([PC] 4.2, 4.3)."""
