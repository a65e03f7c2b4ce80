"""Shape constraints S(T(t)): splines through the control points of places, rotations and lengths."""
