"""The edits: a whole clip changed by coefficients solved at one frame ([PC] 4.3)."""
