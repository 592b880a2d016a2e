"""Structural damping matrices: modal, Rayleigh; viscous dampers and hysteretic damping need none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from aeroservo.datatypes import Array, ModalModel
from aeroservo.structure.modal import natural_modes


def modal_damping(modes: ModalModel, ratios: Sequence[float]) -> Array:
    """Damping matrix that gives each natural mode its own damping ratio.

    Parameters
    ----------
    modes : ModalModel
        The structure; its own D is not used.
    ratios : sequence of float, length n or less
        Damping ratios of the elastic modes in order of frequency; rigid-body modes, and modes beyond the list, are
        undamped. [-]

    Returns
    -------
    D : ndarray, shape (n, n)
        M Phi diag(2 zeta omega / m) Phi^T M. [SI]

    Raises
    ------
    ValueError
        If there are more ratios than elastic modes.

    References
    ----------
    equations.md, "Simulation model" (elsewhere modal damping); Bramstång 2015, section 7.4.1.

    Examples
    --------
    >>> one = ModalModel(M=[[2.0]], D=[[0.0]], K=[[8.0]], names=("h",))
    >>> modal_damping(one, [0.1]).round(9).tolist()
    [[0.8]]
    """
    natural = natural_modes(modes)
    elastic = np.flatnonzero(natural.omega > 0.0)
    if len(ratios) > elastic.size:
        raise ValueError(f"damping.modal.ratios: {len(ratios)} given, the model has {elastic.size} elastic modes")
    zeta = np.zeros(modes.n)
    zeta[elastic[: len(ratios)]] = ratios
    weighted = modes.M @ natural.shapes
    return np.asarray((weighted * (2.0 * zeta * natural.omega / natural.generalized_mass)) @ weighted.T)


def rayleigh_coefficients(omega: tuple[float, float], zeta: tuple[float, float]) -> tuple[float, float]:
    """Coefficients of D = alpha M + beta K that give two modes their damping ratios.

    Parameters
    ----------
    omega : (float, float)
        Two different frequencies. [rad/s]
    zeta : (float, float)
        Damping ratios there. [-]

    Returns
    -------
    alpha, beta : float
        Coefficients. [1/s, s]

    Raises
    ------
    ValueError
        If the frequencies are equal.

    References
    ----------
    Bramstång 2015, Eqs. 7.38-7.40 with the signs of equations.md, "Moving axes, structural damping".

    Examples
    --------
    >>> alpha, beta = rayleigh_coefficients((10.0, 30.0), (0.02, 0.02))
    >>> round(alpha / 20.0 + beta * 10.0 / 2.0, 9)
    0.02
    """
    (wa, wb), (za, zb) = omega, zeta
    if wa == wb:
        raise ValueError(f"Rayleigh damping needs two different frequencies [rad/s], got {wa:g} twice")
    span = wb**2 - wa**2
    return 2.0 * wa * wb * (za * wb - zb * wa) / span, 2.0 * (zb * wb - za * wa) / span
