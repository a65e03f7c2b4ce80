"""Editing by constraints in strict priority layers: every frame deformed, kept continuous ([PRIO])."""
