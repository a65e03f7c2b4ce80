"""Runs over many clips: what is to be done, by whom, and files that are whole or not there."""
