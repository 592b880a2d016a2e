"""Rational approximation of sampled air forces (Roger), with its error reported."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.datatypes import Array, RationalAero, SampledAero

WIDE = 10.0
"""Samples that reach beyond this reduced frequency are fitted up to `DEFAULT_K` only. [-]"""

DEFAULT_K = 3.0
"""Where flutter of wings lives, with room: upper end of the fit of samples that go on without end. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class RationalFit:
    """A rational approximation and how good it is.

    Attributes
    ----------
    aero : RationalAero
        The approximation.
    column_errors : ndarray, shape (n_in,)
        Largest |fit - Q| over samples, Mach numbers and rows, as part of the largest |Q| of the column. [-]
    k_max : float
        Upper end of the fitted range. [-]
    """

    aero: RationalAero
    column_errors: Array
    k_max: float

    @property
    def error(self) -> float:
        """Largest of the column errors. [-]"""
        return float(self.column_errors.max())

    @property
    def worst_input(self) -> str:
        """Name of the column with the largest error."""
        return self.aero.inputs[int(np.argmax(self.column_errors))].name


def fit_rational(aero: SampledAero, *, lags: Array | None = None, k_max: float | None = None) -> RationalFit:
    """Fit Q(ik) = A0 + A1 ik + A2 (ik)^2 + sum_j D_j ik / (ik + gamma_j) to samples.

    Roger's form: least squares, real coefficients, poles given. A0 is not fitted but set to Q(0), so
    statics and divergence stay exact; gust columns have no A1 and A2; columns that do not depend on k
    get no lags. The theory stops at poles: a Q with rapid changes in k needs more of them.

    Parameters
    ----------
    aero : SampledAero
        Samples; five or more reduced frequencies.
    lags : array_like, shape (n_lags,), optional
        Reduced poles gamma_j, positive. Default six, spaced geometrically over the range of the fit. [-]
    k_max : float, optional
        Upper end of the range fitted. Default the last sample, or 3 where samples go beyond 10. [-]

    Returns
    -------
    fit : RationalFit
        The approximation and its error in each column. [SI]

    Raises
    ------
    ValueError
        If there are fewer samples in the range than a fit needs, or a pole is not positive.

    References
    ----------
    Roger, AGARD CP-228, 1977; equations.md, "One equation of motion for every model".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput
    >>> k = np.linspace(0.0, 2.0, 21)
    >>> Q = (1.0 + 2.0j * k)[None, :, None, None]
    >>> fit = fit_rational(SampledAero(k=k, Q=Q, b=1.0, inputs=(AeroInput(name="h", kind="mode"),)))
    >>> bool(fit.error < 1e-10), fit.aero.A1.round(6).tolist()
    (True, [[[2.0]]])
    """
    top = k_max if k_max is not None else (aero.k[-1] if aero.k[-1] <= WIDE else DEFAULT_K)
    k = aero.k[aero.k <= top]
    varies = np.any(np.abs(aero.Q - aero.Q[:, :1]) > 1e-14 * np.abs(aero.Q).max(initial=0.0), axis=(0, 1, 2))
    poles = _default_lags(top) if lags is None else np.asarray(lags, dtype=float)
    if np.any(poles <= 0.0):
        raise ValueError(f"lags must be positive reduced poles [-], got {poles.min():g}")
    if np.any(varies) and 2 * len(k) < len(poles) + 4:
        raise ValueError(
            f"a fit with {len(poles)} lags needs {len(poles) // 2 + 2} or more reduced frequencies up to {top:g}, "
            f"got {len(k)}"
        )
    n_mach, _, n, n_in = aero.Q.shape
    A = np.zeros((3, n_mach, n, n_in))
    D = np.zeros((len(poles), n_mach, n, n_in))
    at_zero = np.stack([aero(0.0, mach) for mach in aero.mach])
    A[0] = at_zero.real
    for j in np.flatnonzero(varies):
        gust = aero.inputs[j].kind == "gust"
        _fit_column(aero.Q[:, : len(k), :, j], k, poles, A[..., j], D[..., j], gust)
    columns = np.flatnonzero(varies)
    fitted = RationalAero(
        A0=A[0],
        A1=A[1],
        A2=A[2],
        b=aero.b,
        inputs=aero.inputs,
        mach=aero.mach,
        lags=np.repeat(poles, len(columns)),
        lag_D=np.concatenate([D_j[..., columns] for D_j in D], axis=-1),
        lag_E=np.tile(np.eye(n_in)[columns], (len(poles), 1)),
    )
    difference = np.stack([fitted(k, mach) for mach in aero.mach]) - aero.Q[:, : len(k)]
    largest = np.abs(aero.Q[:, : len(k)]).max(axis=(0, 1, 2))
    errors = np.abs(difference).max(axis=(0, 1, 2)) / np.where(largest > 0.0, largest, 1.0)
    return RationalFit(aero=fitted, column_errors=errors, k_max=float(top))


def _fit_column(Q: Array, k: Array, poles: Array, A: Array, D: Array, gust: bool) -> None:
    """Least squares for one column; Q (n_mach, n_k, n); fills A[1:], D in place."""
    ik = 1j * k[:, None]
    basis = ik / (ik + poles)
    if not gust:
        basis = np.hstack([ik, ik**2, basis])
    stacked = np.vstack([basis.real, basis.imag])
    weight = 1.0 / np.linalg.norm(stacked, axis=0)
    wanted = Q - A[0][:, None, :]
    right = np.concatenate([wanted.real, wanted.imag], axis=1)
    right = np.moveaxis(right, 1, 0).reshape(2 * len(k), -1)
    found = np.linalg.lstsq(stacked * weight, right, rcond=1e-11)[0] * weight[:, None]
    found = found.reshape(-1, *A.shape[1:])
    if gust:
        D[:] = found
    else:
        A[1:], D[:] = found[:2], found[2:]


def _default_lags(top: float) -> Array:
    """Six poles over two and a half decades below the top of the range."""
    return np.geomspace(top / 300.0, top, 6)
