"""Theodorsen's constants of a flap on a thin aerofoil, a sealed hinge on the chord line."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import frozen

__all__ = ["FlapFunctions", "flap_functions"]

Real = NDArray[np.floating]


@dataclass(frozen=True, kw_only=True, eq=False)
class FlapFunctions:
    """Theodorsen's constants of a flap's geometry, those that the air forces use.

    Parameters
    ----------
    T1, T3, T4, T5, T7, T8, T9, T10, T11, T12, T13 : ndarray, shape (...)
        In Theodorsen's numbering; T9 and T13 depend on the pitch axis too. T2, T6 and T14 belong to tabs and to
        combinations that do not occur here. [-]

    References
    ----------
    T. Theodorsen, NACA Report 496, 1935, appendix.

    Examples
    --------
    >>> print(f"{flap_functions(0.5, a=-0.2).T12:.6f}")
    0.070668
    """

    T1: Real  # (...)  [-]
    T3: Real  # (...)  [-]
    T4: Real  # (...)  [-]
    T5: Real  # (...)  [-]
    T7: Real  # (...)  [-]
    T8: Real  # (...)  [-]
    T9: Real  # (...)  [-]
    T10: Real  # (...)  [-]
    T11: Real  # (...)  [-]
    T12: Real  # (...)  [-]
    T13: Real  # (...)  [-]

    def __post_init__(self) -> None:
        for field in fields(self):
            object.__setattr__(self, field.name, frozen(getattr(self, field.name), name=field.name))


def flap_functions(hinge: ArrayLike, a: ArrayLike) -> FlapFunctions:
    """Theodorsen's T-functions of a flap hinged on the chord line.

    Parameters
    ----------
    hinge : array_like, shape (...)
        Hinge, semichords aft of mid-chord, from -1 (leading edge) to below 1 (trailing edge). [-]
    a : array_like, shape (...)
        Pitch axis, semichords aft of mid-chord. [-]

    Returns
    -------
    T : FlapFunctions
        T1, T3, T4, T5, T7 to T13, each of the broadcast shape (...).

    Raises
    ------
    ValueError
        If a hinge is not in [-1, 1), or `a` is not finite.

    References
    ----------
    T. Theodorsen, NACA Report 496, 1935, appendix.

    Examples
    --------
    >>> T = flap_functions(0.0, a=0.0)
    >>> float(T.T4) == -np.pi / 2, round(float(T.T10), 6)
    (True, 2.570796)
    """
    c, a = np.broadcast_arrays(np.asarray(hinge, dtype=float), frozen(a, name="pitch axis a"))
    inside = (c >= -1.0) & (c < 1.0)
    if not np.all(inside):
        raise ValueError(f"hinge must be from -1 to below 1 [semichords aft of mid-chord], got {c[~inside].flat[0]:g}")
    r, phi = np.sqrt((1.0 - c) * (1.0 + c)), np.arccos(c)
    T1 = -r * (2.0 + c**2) / 3.0 + c * phi
    T4 = -phi + c * r
    T7 = -(0.125 + c**2) * phi + c * r * (7.0 + 2.0 * c**2) / 8.0
    return FlapFunctions(
        T1=T1,
        T3=-(0.125 + c**2) * phi**2 + c * r * phi * (7.0 + 2.0 * c**2) / 4.0 - r**2 * (5.0 * c**2 + 4.0) / 8.0,
        T4=T4,
        T5=-(r**2) - phi**2 + 2.0 * c * r * phi,
        T7=T7,
        T8=-r * (2.0 * c**2 + 1.0) / 3.0 + c * phi,
        T9=0.5 * (r**3 / 3.0 + a * T4),
        T10=r + phi,
        T11=phi * (1.0 - 2.0 * c) + r * (2.0 - c),
        T12=r * (2.0 + c) - phi * (2.0 * c + 1.0),
        T13=0.5 * (-T7 - (c - a) * T1),
    )
