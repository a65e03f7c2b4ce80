"""Clips of one behaviour onto one timeline ([PC] 5)."""
