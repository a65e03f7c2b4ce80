"""The layered solver: tasks in strict priority layers over the unknowns of many frames, in numpy and in C."""
