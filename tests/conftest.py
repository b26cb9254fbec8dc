"""Two OpenMP threads that spin while they wait starve each other on a busy machine; tests may share theirs."""

import os

os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # before the first kernel runs: read once by the threading layer
