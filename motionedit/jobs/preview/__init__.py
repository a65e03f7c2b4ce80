"""Clips to look at: bodies, goals and constraints on a page, or a contact sheet."""
