"""Strips of a half wing and their motion in modes; the air forces on them are in `strip`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.datatypes import Array, ModalModel, frozen


@dataclass(frozen=True, kw_only=True, eq=False)
class StripControl:
    """Section derivatives of one control, on every strip that feels it.

    Attributes
    ----------
    name : str
        Name of its column.
    lift, moment : ndarray, shape (n_strips,)
        Of the section normal to the axis, per radian: lift, and moment about the flexural axis, nose up. [1/rad]
    """

    name: str
    lift: Array
    moment: Array

    def __post_init__(self) -> None:
        """Lock the arrays."""
        for name in ("lift", "moment"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=1, name=f"{name} of {self.name!r}"))


@dataclass(frozen=True, kw_only=True, eq=False)
class Strips:
    """Strips of a half wing, in order along the flexural axis.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Distance of each strip from the plane of symmetry, in the span. [m]
    width : ndarray, shape (n,)
        Length of axis that each stands for (a quadrature weight). [m]
    b : ndarray, shape (n,)
        Semi-chord normal to the axis. [m]
    a : ndarray, shape (n,)
        Flexural axis, semi-chords aft of mid-chord. [-]
    eccentricity : ndarray, shape (n,)
        Flexural axis aft of the aerodynamic centre, in chords; used by quasi-steady theory only. [-]
    lift_slope : ndarray, shape (n,)
        Lift slope of the section normal to the axis. [1/rad]
    moment_rate : ndarray, shape (n,)
        M_thetadot of the damped quasi-steady theory. [-]
    sweep : ndarray, shape (n,)
        Sweep of the axis, positive aft. [rad]
    elevon_lift, elevon_moment : ndarray, shape (n,)
        a_c and b_c (about the flexural axis, nose up) of the sections that carry the elevon. [1/rad]
    incidence, cm0 : ndarray, shape (n,)
        Built-in incidence of the normal section, nose up, and its moment coefficient without lift. [rad, -]
    span : float
        Distance of the tip from the plane of symmetry. [m]
    hinge : float, optional
        Flap hinge, semi-chords aft of mid-chord, where a flap is one of the coordinates. [-]
    controls : tuple of StripControl
        Controls beside the elevon, or in its place.
    roll_angle : ndarray, shape (n,), optional
        Incidence of each strip in roll at a helix angle p span / V of 1, in the plane of the flow; default y / span.
        Less where neighbours take part of it away. [rad]
    """

    y: Array
    width: Array
    b: Array
    a: Array
    eccentricity: Array
    lift_slope: Array
    moment_rate: Array
    sweep: Array
    elevon_lift: Array
    elevon_moment: Array
    incidence: Array
    cm0: Array
    span: float
    hinge: float | None = None
    controls: tuple[StripControl, ...] = ()
    roll_angle: Array = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        """Broadcast every array over the strips, lock and check them."""
        shape = np.shape(self.y)
        if not self.span > 0.0:
            raise ValueError(f"span must be positive [m], got {self.span:g}")
        if self.roll_angle is None:
            object.__setattr__(self, "roll_angle", np.asarray(self.y) / self.span)
        for name in _STRIP_ARRAYS:
            value = frozen(np.broadcast_to(getattr(self, name), shape), ndim=1, name=name)
            object.__setattr__(self, name, value)
        if np.any(self.b <= 0.0):
            raise ValueError(f"semi-chord b must be positive [m], got {self.b.min():g}")
        if np.any(np.abs(self.sweep) >= 0.5 * np.pi):
            raise ValueError("sweep must lie between -90 and 90 degrees")
        for control in self.controls:
            if control.lift.shape != shape or control.moment.shape != shape:
                raise ValueError(
                    f"control {control.name!r} must have lift and moment on every strip {shape}, got "
                    f"{control.lift.shape} and {control.moment.shape}"
                )


_STRIP_ARRAYS = (
    "y",
    "width",
    "b",
    "a",
    "eccentricity",
    "lift_slope",
    "moment_rate",
    "sweep",
    "elevon_lift",
    "elevon_moment",
    "incidence",
    "cm0",
    "roll_angle",
)


@dataclass(frozen=True, kw_only=True, eq=False)
class StripShapes:
    """Motion of the strips per unit of each mode.

    Attributes
    ----------
    h, twist, slope : ndarray, shape (n_strips, n)
        Plunge down [m], twist about the axis nose up [rad], slope dh/ds along it [rad]. [per unit]
    flap : ndarray, shape (n_strips, n), optional
        Flap angle, trailing edge down. [rad per unit]
    """

    h: Array
    twist: Array
    slope: Array
    flap: Array | None = None


def strip_shapes(modes: ModalModel, sweep: Array, *, bending_slope: bool = True) -> StripShapes:
    """Motion of the strips from the shapes of a modal model, whose first grid points are the strips.

    Parameters
    ----------
    modes : ModalModel
        With `phi` at the strips' points of the flexural axis.
    sweep : ndarray, shape (n_strips,)
        Sweep of the axis at each. [rad]
    bending_slope : bool
        Whether the slope of the axis is kept; without it a swept wing has V cos(Lambda) only.

    Returns
    -------
    shapes : StripShapes
        Plunge [m], twist [rad] and slope [rad] per unit of each mode.

    Raises
    ------
    ValueError
        If the modal model has fewer grid points than there are strips.

    References
    ----------
    equations.md, "Conventions": x aft, y starboard, z up; h down, nose up is a rotation about +y.

    Examples
    --------
    >>> phi = np.zeros((1, 6, 1)); phi[0, 2] = -1.0
    >>> heave = ModalModel(M=[[1.0]], D=[[0.0]], K=[[0.0]], names=("heave",), phi=phi, grid=[[0.0, 1.0, 0.0]])
    >>> strip_shapes(heave, np.zeros(1)).h.tolist()
    [[1.0]]
    """
    n = len(sweep)
    phi = np.asarray(modes.phi)
    if phi.shape[0] < n:
        raise ValueError(f"phi must hold at least the {n} strips, got {phi.shape[0]} grid points")
    sin, cos = np.sin(sweep)[:, None], np.cos(sweep)[:, None]
    slope = sin * phi[:n, 4] - cos * phi[:n, 3]
    return StripShapes(
        h=-phi[:n, 2], twist=sin * phi[:n, 3] + cos * phi[:n, 4], slope=slope if bending_slope else 0.0 * slope
    )
