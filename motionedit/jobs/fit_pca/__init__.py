"""Normalized clips in, a motion PCA model out ([PC] 4.1)."""
