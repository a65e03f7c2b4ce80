"""Accuracy, and the figures of both papers: run from the root of the project, as `python -m studies.figures`."""

import os

# As the program itself does, and before numpy is loaded.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
