"""Aerodynamic coefficients of a whole aircraft, from a lattice, from polars or from a wind tunnel alike.

Signs: lift up, pitching moment nose up, drag aft, alpha nose up, q nose up, deflection trailing edge down. The object
carries the reference area, chord and point and how its rates are made dimensionless, and converts them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from aeroservo.datatypes import frozen

Rates = Literal["c/(2V)", "c/V", "1/V"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """What coefficients are made dimensionless with, and where moments are taken.

    Parameters
    ----------
    S, c, b : float
        Area [m^2], chord [m] and span [m]; all positive.
    point : tuple of float, length 3
        Moment point in geometry axes: x aft, y to starboard, z up. [m]
    """

    S: float
    c: float
    b: float
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name, unit in (("S", "m^2"), ("c", "m"), ("b", "m")):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise ValueError(f"reference {name} must be > 0 [{unit}], got {value:g}")
        point = tuple(float(v) for v in self.point)
        if len(point) != 3 or not np.all(np.isfinite(point)):
            raise ValueError(f"reference point must be three finite numbers [m], got {self.point}")
        object.__setattr__(self, "point", point)

    @property
    def x(self) -> float:
        """Position of the moment point, aft [m]."""
        return self.point[0]


@dataclass(frozen=True, kw_only=True, eq=False)
class CoefficientTable:
    """Coefficients over Reynolds number, deflection and angle of attack; NaN where nothing was measured.

    Parameters
    ----------
    alpha, delta, reynolds : array_like, shapes (n_a,), (n_d,), (n_r,)
        Ascending axes [rad], [rad], [-]; a single zero where there is no such axis.
    CL, CD, CM : array_like, shape (n_r, n_d, n_a)
        Wind axes; CM about the reference point. [-]
    """

    alpha: np.ndarray
    delta: np.ndarray
    reynolds: np.ndarray
    CL: np.ndarray
    CD: np.ndarray
    CM: np.ndarray

    def __post_init__(self) -> None:
        for name in ("alpha", "delta", "reynolds"):
            axis = frozen(getattr(self, name), ndim=1, name=name)
            if np.any(np.diff(axis) <= 0.0):
                raise ValueError(f"axis {name} must ascend without repeats")
            object.__setattr__(self, name, axis)
        shape = (len(self.reynolds), len(self.delta), len(self.alpha))
        for name in ("CL", "CD", "CM"):
            table = np.array(getattr(self, name), dtype=float)
            if table.shape != shape:
                raise ValueError(f"table {name} must have shape {shape} (reynolds, delta, alpha), got {table.shape}")
            table.flags.writeable = False
            object.__setattr__(self, name, table)


@dataclass(frozen=True, kw_only=True, eq=False)
class AeroCoefficients:
    """Linear coefficients about alpha = 0, with the table they were fitted to where there is one.

    Parameters
    ----------
    reference : Reference
        Area, chord, span, moment point. The rates turn about that point.
    rates : {"c/(2V)", "c/V", "1/V"}
        What q and alphadot are multiplied with: CL_q is per radian, or per (rad/m) for "1/V".
    CL0, CM0, CD0 : float
        Values at alpha = 0, no deflection. [-]
    CL_alpha, CM_alpha : float
        [1/rad]
    CL_q, CM_q, CL_alphadot, CM_alphadot : float or None
        None where the source does not know them. [1/rad, or rad/m for "1/V"]
    controls : tuple of str
        Names of the controls.
    CL_delta, CM_delta : array_like, shape (n_controls,)
        Per radian of streamwise deflection. [1/rad]
    span_efficiency : float or None
        e of CD = CD0 + CL^2/(pi AR e). [-]
    table : CoefficientTable or None
        What was measured or computed.
    source : str
        Where the figures come from.
    """

    reference: Reference
    rates: Rates = "c/(2V)"
    CL0: float
    CM0: float
    CD0: float | None = None
    CL_alpha: float
    CM_alpha: float
    CL_q: float | None = None
    CM_q: float | None = None
    CL_alphadot: float | None = None
    CM_alphadot: float | None = None
    controls: tuple[str, ...] = ()
    CL_delta: np.ndarray | Sequence[float] = ()
    CM_delta: np.ndarray | Sequence[float] = ()
    span_efficiency: float | None = None
    table: CoefficientTable | None = None
    source: str = ""

    def __post_init__(self) -> None:
        if self.rates not in ("c/(2V)", "c/V", "1/V"):
            raise ValueError(f'rates must be "c/(2V)", "c/V" or "1/V", got {self.rates!r}')
        for name in ("CL_delta", "CM_delta"):
            value = frozen(getattr(self, name), ndim=1, name=name)
            if value.shape != (len(self.controls),):
                raise ValueError(f"{name} needs one value for each of {len(self.controls)} controls, got {value.shape}")
            object.__setattr__(self, name, value)

    @property
    def neutral_point(self) -> float:
        """Position x where CM_alpha vanishes [m]."""
        return self.reference.x - self.reference.c * self.CM_alpha / self.CL_alpha


def coefficients_about(coefficients: AeroCoefficients, point: Sequence[float]) -> AeroCoefficients:
    """The same aircraft with moments taken, and rates turning, about another point.

    Parameters
    ----------
    coefficients : AeroCoefficients
        Coefficients about their own reference point.
    point : sequence of float, length 3
        New point; on the same y. [m]

    Returns
    -------
    AeroCoefficients
        Linear terms: the lift is the normal force and drag's arm is neglected; the table, if any, is moved with
        its normal and axial force exactly.

    Raises
    ------
    ValueError
        If the new point lies beside the old one's plane.

    References
    ----------
    Statics, and the change of angle of attack (x - x') q/V at the old point when the body turns about the new one;
    B. Etkin, L. Reid, Dynamics of Flight, 1996, section 5.

    Examples
    --------
    >>> ref = Reference(S=1.0, c=0.5, b=2.0)
    >>> plate = AeroCoefficients(reference=ref, CL0=0.0, CM0=0.0, CL_alpha=4.0, CM_alpha=-1.0)
    >>> coefficients_about(plate, (0.125, 0.0, 0.0)).CM_alpha
    0.0
    """
    old, c = coefficients.reference, coefficients.reference.c
    new = replace(old, point=(float(point[0]), float(point[1]), float(point[2])))
    if abs(new.point[1] - old.point[1]) > 1e-12:
        raise ValueError(f"the point may move in x and z only [m], got y = {new.point[1]:g}, was {old.point[1]:g}")
    arm = (new.x - old.x) / c
    factor = rate_length(coefficients.rates, c)
    turn = -(new.x - old.x) / factor  # angle of attack at the old point per unit of the new rate

    def moved(moment: float | None, lift: float | None) -> float | None:
        return None if moment is None or lift is None else moment + arm * lift

    CL_q, CM_q = coefficients.CL_q, coefficients.CM_q
    CL_q = None if CL_q is None else CL_q + turn * coefficients.CL_alpha
    CM_q = None if CM_q is None else CM_q + turn * coefficients.CM_alpha
    table = coefficients.table
    if table is not None:
        CN, CA = body_axes(table.CL, table.CD, table.alpha)
        height = (new.point[2] - old.point[2]) / c
        table = replace(table, CM=table.CM + arm * CN - height * CA)
    return replace(
        coefficients,
        reference=new,
        CM0=coefficients.CM0 + arm * coefficients.CL0,
        CM_alpha=coefficients.CM_alpha + arm * coefficients.CL_alpha,
        CL_q=CL_q,
        CM_q=moved(CM_q, CL_q),
        CM_alphadot=moved(coefficients.CM_alphadot, coefficients.CL_alphadot),
        CM_delta=np.asarray(coefficients.CM_delta) + arm * np.asarray(coefficients.CL_delta),
        table=table,
    )


def coefficients_on(coefficients: AeroCoefficients, *, S: float, c: float, b: float, rates: Rates) -> AeroCoefficients:
    """The same aircraft on another reference area, chord and span, and another normalisation of rates.

    Parameters
    ----------
    coefficients : AeroCoefficients
        Coefficients.
    S, c, b : float
        New area [m^2], chord [m] and span [m].
    rates : {"c/(2V)", "c/V", "1/V"}
        New normalisation, with the new chord.

    Returns
    -------
    AeroCoefficients
        Forces and moments are unchanged.

    Raises
    ------
    ValueError
        If a length is not positive or the normalisation unknown.

    References
    ----------
    B. Etkin, L. Reid, Dynamics of Flight, 1996, section 4.1 (definitions of the coefficients).

    Examples
    --------
    >>> ref = Reference(S=1.0, c=0.5, b=2.0)
    >>> plate = AeroCoefficients(reference=ref, CL0=0.1, CM0=0.0, CL_alpha=4.0, CM_alpha=-1.0, CL_q=3.0, CM_q=-1.0)
    >>> coefficients_on(plate, S=2.0, c=0.5, b=2.0, rates="c/V").CL_q
    0.75
    """
    old = coefficients.reference
    new = Reference(S=S, c=c, b=b, point=old.point)
    force, moment = old.S / S, old.S * old.c / (S * c)
    ratio = rate_length(rates, c) / rate_length(coefficients.rates, old.c)

    def scaled(value: float | None, factor: float) -> float | None:
        return None if value is None else value * factor

    table = coefficients.table
    if table is not None:
        table = replace(table, CL=table.CL * force, CD=table.CD * force, CM=table.CM * moment)
    e = coefficients.span_efficiency  # CD = CD0 + CL^2 S/(pi b^2 e): on another span the same drag needs another e
    return replace(
        coefficients,
        reference=new,
        rates=rates,
        CL0=coefficients.CL0 * force,
        CM0=coefficients.CM0 * moment,
        CD0=scaled(coefficients.CD0, force),
        CL_alpha=coefficients.CL_alpha * force,
        CM_alpha=coefficients.CM_alpha * moment,
        CL_q=scaled(coefficients.CL_q, force / ratio),
        CM_q=scaled(coefficients.CM_q, moment / ratio),
        CL_alphadot=scaled(coefficients.CL_alphadot, force / ratio),
        CM_alphadot=scaled(coefficients.CM_alphadot, moment / ratio),
        CL_delta=np.asarray(coefficients.CL_delta) * force,
        CM_delta=np.asarray(coefficients.CM_delta) * moment,
        span_efficiency=scaled(e, (old.b / b) ** 2),
        table=table,
    )


def rate_length(rates: Rates, c: float) -> float:
    """Length that a rate over airspeed is multiplied with.

    Parameters
    ----------
    rates : {"c/(2V)", "c/V", "1/V"}
        Normalisation.
    c : float
        Reference chord. [m]

    Returns
    -------
    length : float
        c/2, c or 1. [m]

    Raises
    ------
    ValueError
        If the normalisation is unknown.

    References
    ----------
    Bramstång 2015, thesis [7.47], which uses c/(2U).

    Examples
    --------
    >>> rate_length("c/(2V)", 0.5)
    0.25
    """
    lengths = {"c/(2V)": c / 2.0, "c/V": c, "1/V": 1.0}
    if rates not in lengths:
        raise ValueError(f'rates must be "c/(2V)", "c/V" or "1/V", got {rates!r}')
    return lengths[rates]


def body_axes(CL: np.ndarray, CD: np.ndarray, alpha: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Normal and axial force coefficients from lift and drag.

    Parameters
    ----------
    CL, CD : array_like, shape (...)
        Lift and drag coefficients. [-]
    alpha : array_like, shape that broadcasts to (...)
        Angle of attack. [rad]

    Returns
    -------
    CN, CA : ndarray, shape (...)
        Normal to the body's x axis (up) and along it (aft). [-]

    References
    ----------
    Rotation by alpha; B. Etkin, L. Reid, Dynamics of Flight, 1996, Eq. 1.6.

    Examples
    --------
    >>> CN, CA = body_axes(np.array(1.0), np.array(0.0), 0.1)
    >>> round(float(CN), 6), round(float(CA), 6)
    (0.995004, -0.099833)
    """
    cos, sin = np.cos(alpha), np.sin(alpha)
    return np.asarray(CL) * cos + np.asarray(CD) * sin, np.asarray(CD) * cos - np.asarray(CL) * sin


def wind_axes(CN: np.ndarray, CA: np.ndarray, alpha: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Lift and drag coefficients from normal and axial force: the inverse of `body_axes`.

    Parameters
    ----------
    CN, CA : array_like, shape (...)
        Normal and axial force coefficients. [-]
    alpha : array_like, shape that broadcasts to (...)
        Angle of attack. [rad]

    Returns
    -------
    CL, CD : ndarray, shape (...)
        Lift and drag coefficients. [-]

    References
    ----------
    Rotation by -alpha; B. Etkin, L. Reid, Dynamics of Flight, 1996, Eq. 1.6.

    Examples
    --------
    >>> CL, CD = wind_axes(*body_axes(np.array(0.7), np.array(0.02), 0.2), 0.2)
    >>> round(float(CL), 12), round(float(CD), 12)
    (0.7, 0.02)
    """
    return body_axes(CN, CA, -np.asarray(alpha))
