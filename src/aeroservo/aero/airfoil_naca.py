"""NACA 4- and 5-digit airfoils from their formulas."""

from __future__ import annotations

import numpy as np

#: Second and third digit: station m and factor k1 of the mean line for a design lift of 0.3.
_STANDARD = {10: (0.0580, 361.4), 20: (0.1260, 51.64), 30: (0.2025, 15.957), 40: (0.2900, 6.643), 50: (0.3910, 3.230)}
#: The same for reflexed mean lines, with the ratio k2/k1.
_REFLEXED = {
    21: (0.1300, 51.990, 0.000764),
    31: (0.2170, 15.793, 0.00677),
    41: (0.3180, 6.520, 0.0303),
    51: (0.4410, 3.191, 0.1355),
}


def naca_camber(digits: str, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean line of a NACA 4- or 5-digit airfoil and its slope.

    Parameters
    ----------
    digits : str
        "2412", "23012" and the like.
    x : array_like, shape (...)
        Stations in [0, 1]. [-]

    Returns
    -------
    z, slope : ndarray, shape (...)
        Height over the chord and dz/dx. [-]

    Raises
    ------
    ValueError
        If there is no such mean line.

    References
    ----------
    E. Jacobs, K. Ward, R. Pinkerton, NACA Report 460, 1933, section "Description of airfoils"; E. Jacobs, R. Pinkerton,
    NACA Report 537, 1935, Table I; C. Ladson, C. Brooks, NASA TM X-3284, 1975.

    Examples
    --------
    >>> z, slope = naca_camber("2412", np.array([0.4]))
    >>> float(z[0]), float(slope[0])
    (0.02, 0.0)
    """
    x = np.asarray(x, dtype=float)
    if len(digits) == 4 and digits.isdigit():
        m, p = int(digits[0]) / 100.0, int(digits[1]) / 10.0
        if m == 0.0:
            return np.zeros_like(x), np.zeros_like(x)
        if p == 0.0:
            raise ValueError(f"NACA {digits}: camber needs its position (second digit 1 to 9)")
        side = np.where(x < p, p, 1.0 - p)
        front = np.where(x < p, 0.0, 1.0 - 2.0 * p)
        return m * (front + 2.0 * p * x - x**2) / side**2, 2.0 * m * (p - x) / side**2
    if len(digits) == 5 and digits.isdigit():
        factor, kind = int(digits[0]) / 2.0, int(digits[1:3])
        if kind in _STANDARD:
            m, k1 = _STANDARD[kind]
            k1 *= factor
            z = np.where(x < m, x**3 - 3 * m * x**2 + m**2 * (3 - m) * x, m**3 * (1 - x)) * k1 / 6.0
            slope = np.where(x < m, 3 * x**2 - 6 * m * x + m**2 * (3 - m), -(m**3)) * k1 / 6.0
            return z, slope
        if kind in _REFLEXED:
            m, k1, ratio = _REFLEXED[kind]
            k1 *= factor
            line = -ratio * (1 - m) ** 3 * x - m**3 * x + m**3
            z = np.where(x < m, (x - m) ** 3, ratio * (x - m) ** 3) + line
            slope = np.where(x < m, 3 * (x - m) ** 2, 3 * ratio * (x - m) ** 2) - ratio * (1 - m) ** 3 - m**3
            return k1 / 6.0 * z, k1 / 6.0 * slope
    known = ", ".join(f"x{k}xx" for k in sorted([*_STANDARD, *_REFLEXED]))
    raise ValueError(f"no mean line for NACA {digits!r}: four digits, or five as in {known}")


def naca_outline(digits: str, n: int = 160) -> np.ndarray:
    """Outline of a NACA 4- or 5-digit airfoil with a closed trailing edge.

    Parameters
    ----------
    digits : str
        "2412", "23012" and the like; the last two are the thickness in per cent.
    n : int
        Number of panels, even.

    Returns
    -------
    points : ndarray, shape (n + 1, 2)
        From the trailing edge over the upper surface round to the lower one. [-]

    Raises
    ------
    ValueError
        If there is no such airfoil.

    References
    ----------
    NACA Report 460, 1933; closed trailing edge: last coefficient -0.1036 instead of -0.1015, as in C. Ladson,
    C. Brooks, NASA TM X-3284, 1975, section "Thickness distribution".

    Examples
    --------
    >>> naca_outline("0012")[0].tolist()
    [1.0, 0.0]
    """
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, n // 2 + 1)))
    z, slope = naca_camber(digits, x)
    t = int(digits[-2:]) / 100.0
    if t <= 0.0:
        raise ValueError(f"NACA {digits}: the last two digits are the thickness in per cent and must not be 00")
    half = 5.0 * t * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    half[-1] = 0.0
    angle = np.arctan(slope)
    upper = np.stack([x - half * np.sin(angle), z + half * np.cos(angle)], axis=-1)
    lower = np.stack([x + half * np.sin(angle), z - half * np.cos(angle)], axis=-1)
    return np.concatenate([upper[::-1], lower[1:]]) + 0.0
