"""Feet that stand, put right by the legs alone."""
