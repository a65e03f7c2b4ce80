"""The Python face: the four commands and the reader as functions that print nothing and need no file."""
