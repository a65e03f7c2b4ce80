"""Goals at single frames, within the style of a model ([PC] 4.2, 4.3)."""
