"""Ratios of our time to a peer's, measured side by side in one run, one thread of linear algebra each."""

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
