"""Inverse kinematics: goals, and the solver in the space of the motion principal coefficients ([PC] 4.2)."""
