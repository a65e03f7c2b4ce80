"""Hands that hold one thing: where a clip's do, and two arms that keep them together."""
