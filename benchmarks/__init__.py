"""Speed, scale and peers: run from the root of the project, as `python -m benchmarks.run`."""

import os

# As the program itself does, and before numpy is loaded.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
