"""Feet that stand: their phases and places, corrections that ease between them, and legs solved onto them."""
