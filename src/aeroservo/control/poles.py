"""Pole placement by state feedback, checked by the roots of the closed loop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.control.design import Design, controls, feedback
from aeroservo.control.verify import WEAK, modes_out_of_reach
from aeroservo.datatypes import Array, LinearSystem, frozen

PLACED = 1e-6
"""Largest relative difference of the characteristic polynomial from the wanted one. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class PolePlacement:
    """u = -K x with the closed loop's roots where they are wanted.

    Attributes
    ----------
    poles : complex ndarray, shape (n,)
        Wanted roots, as s also for a sampled plant (z = e^(s dt)), complex ones in pairs. Fewer than the states of a
        sampled plant: the others go to z = 0, where a delay has them. [1/s]
    measured : tuple of str, optional
        States that the controller reads, as of `LQR`.
    """

    poles: Array
    measured: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        """Lock the poles and check that they come in pairs."""
        poles = frozen(np.atleast_1d(self.poles), dtype=complex, ndim=1, name="poles")
        if not np.allclose(np.sort_complex(poles), np.sort_complex(poles.conj()), rtol=1e-12, atol=0.0):
            raise ValueError(f"complex poles must come in conjugate pairs [1/s], got {poles.tolist()}")
        object.__setattr__(self, "poles", poles)

    def __call__(self, plant: LinearSystem) -> Design:
        """Design for a plant, or for each of a batch.

        Parameters
        ----------
        plant : LinearSystem
            Continuous or sampled; gust inputs are left alone. [SI]

        Returns
        -------
        design : Design
            Residual: characteristic polynomial of A - B K against the wanted one. [SI]

        Raises
        ------
        ValueError
            If the number of poles is wrong, a mode is out of reach, or the roots do not arrive.

        References
        ----------
        J. Kautsky, N. K. Nichols and P. Van Dooren, Int. J. Control 41(5), 1985 (robust placement); J. Ackermann,
        Regelungstechnik 20, 1972, p. 297 (one input).

        Examples
        --------
        >>> names = {"states": ("x", "v"), "inputs": ("u",), "outputs": ("x", "v")}
        >>> two = LinearSystem(A=[[0, 1], [0, 0]], B=[[0], [1]], C=np.eye(2), D=np.zeros((2, 1)), **names)
        >>> PolePlacement(poles=[-1.0 + 1.0j, -1.0 - 1.0j])(two).K.round(9).tolist()
        [[2.0, 2.0]]
        """
        u = controls(plant)
        n = len(u.states)
        if len(self.poles) > n or (u.dt is None and len(self.poles) != n):
            raise ValueError(
                f"poles must be {n} [1/s], one for each of {', '.join(u.states)}; got {len(self.poles)}"
                + ("" if u.dt is None else " (fewer are allowed: the others go to z = 0)")
            )
        wanted = self.poles if u.dt is None else np.exp(self.poles * u.dt)
        wanted = np.concatenate([wanted, np.zeros(n - len(wanted))])
        batch = u.A.shape[:-2]
        K, residual = np.zeros((*batch, len(u.inputs), n)), np.zeros(batch)
        for i in np.ndindex(*batch):
            K[i], residual[i] = place(u.A[i], u.B[i], wanted, u.states, dt=u.dt)
        return feedback(u, K, method="poles", residual=residual, measured=self.measured)


def place(
    A: Array, B: Array, wanted: Array, states: tuple[str, ...], *, dt: float | None = None
) -> tuple[Array, float]:  # fmt: skip
    """Gain that puts the roots of A - B K where they are wanted, and how far off they are.

    Parameters
    ----------
    A, B : ndarray, shapes (n, n), (n, m)
        One plant. [SI]
    wanted : complex ndarray, shape (n,)
        In s, or z of a sampled plant. [1/s or -]
    states : tuple of str
        Names, for errors.
    dt : float, optional
        Sample time; None is continuous. [s]

    Returns
    -------
    K : ndarray, shape (m, n)
        u = -K x. [SI]
    residual : float
        Characteristic polynomial of the closed loop against the wanted one, on circles outside each root. [-]

    Raises
    ------
    ValueError
        If a mode is out of reach, or the roots do not arrive.

    References
    ----------
    J. Kautsky, N. K. Nichols and P. Van Dooren, Int. J. Control 41(5), 1985; J. Ackermann, Regelungstechnik 20, 1972,
    p. 297.

    Examples
    --------
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> K, residual = place(A, B, np.array([-1.0, -1.0]), ("x", "v"))
    >>> K.round(9).tolist()
    [[1.0, 2.0]]
    """
    from scipy.signal import place_poles

    if B.shape[1] == 1:
        K = _ackermann(A, B, wanted)
    else:
        try:
            K = np.asarray(place_poles(A, B, wanted, rtol=1e-6, maxiter=200).gain_matrix)
        except ValueError as error:
            raise ValueError(f"these poles cannot be placed: {error}{_why(A, B, states, dt)}") from None
    residual = (
        _distance(A - B @ K, wanted, float(np.abs(np.linalg.eigvals(A)).max(initial=0.0)))
        if np.all(np.isfinite(K))
        else np.inf
    )
    if not residual <= PLACED:
        raise ValueError(f"these poles cannot be placed: roots miss them by {residual:.1e}{_why(A, B, states, dt)}")
    return K, residual


def _ackermann(A: Array, B: Array, wanted: Array) -> Array:
    """Ackermann's formula in balanced states, on a Hessenberg form so that no power of A is taken.

    With A unreduced Hessenberg and B = beta e_1, the last row of p(A)/(product of the subdiagonals and beta) is K.
    """
    from scipy.linalg import hessenberg, matrix_balance

    n = len(A)
    balanced, (scale, _) = matrix_balance(A, permute=False, separate=True)
    b = B[:, 0] / scale
    size = float(np.linalg.norm(b))
    if size == 0.0:
        return np.full((1, n), np.inf)
    reflect = np.eye(n)
    reflect[:, 0] = b / size
    first, _ = np.linalg.qr(reflect)
    first[:, 0] *= np.sign(first[:, 0] @ b)
    H, second = hessenberg(first.T @ balanced @ first, calc_q=True)
    basis = first @ second  # b stays on the first axis: Householder of hessenberg leaves it alone
    row = np.zeros(n, dtype=complex)
    row[-1] = 1.0
    for pole in wanted:  # e_n' (H - p_1) (H - p_2) ...
        row = row @ H - pole * row
    product = size * np.prod(np.diag(H, -1)) if n > 1 else size
    if product == 0.0:
        return np.full((1, n), np.inf)
    return np.asarray((row.real / product) @ basis.T / scale)[None, :]


def _distance(closed: Array, wanted: Array, scale: float) -> float:
    """Characteristic polynomial against the wanted one, on a circle outside each wanted root.

    A circle for each, since a far root hides the others; polynomials rather than roots, since repeated roots scatter.
    Roots wanted at the origin are judged on the plant's own scale.
    """
    size = np.abs(wanted)
    radii = np.unique(1.5 * np.where(size > 1e-6 * scale, size, scale or 1.0))
    points = (radii[:, None] * np.exp(1j * np.array([0.3, 1.1, 2.0, 2.9]))).ravel()
    sign, logs = np.linalg.slogdet(points[:, None, None] * np.eye(len(closed)) - closed)
    aim = np.sum(np.log((points[:, None] - wanted).astype(complex)), axis=1)
    return float(np.abs(sign * np.exp(logs - aim) - 1.0).max(initial=0.0))


def _why(A: Array, B: Array, states: tuple[str, ...], dt: float | None) -> str:
    """Modes that are out of reach, in words."""
    found = modes_out_of_reach(A, B, states, dt=dt, below=WEAK)
    if found:
        return f"; {' and '.join(map(str, found))} is out of reach"
    return "; a mode is hardly reached, or poles are too far off for the precision of numbers"
