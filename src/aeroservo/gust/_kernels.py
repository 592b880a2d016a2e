"""Compiled recursion of a time-varying linear filter driven by noise; imports nothing of ours."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def recursion(Ad, Ld, C, x0, noise, hold):
    """y[k] = C[k] x, x <- Ad[k] x + Ld[k] noise[k]; each matrix serves `hold` steps, a single one all."""
    n_t, n_u = noise.shape
    n, n_y = x0.shape[0], C.shape[1]
    x, new = x0.copy(), np.empty(n)
    y = np.empty((n_t, n_y))
    varying = Ad.shape[0] > 1
    for k in range(n_t):
        i = k // hold if varying else 0
        for row in range(n_y):
            total = 0.0
            for col in range(n):
                total += C[i, row, col] * x[col]
            y[k, row] = total
        for row in range(n):
            total = 0.0
            for col in range(n):
                total += Ad[i, row, col] * x[col]
            for col in range(n_u):
                total += Ld[i, row, col] * noise[k, col]
            new[row] = total
        for row in range(n):
            x[row] = new[row]
    return y
