"""The thesis' assumed shapes: a rectangular half wing that bends as (y/s)^2 and twists as y/s, and its heave."""

from __future__ import annotations

import numpy as np

from aeroservo.datatypes import Array, ModalModel


def binary_wing(
    *,
    semi_span: float,
    chord: float,
    flexural_axis: float,
    mass_per_area: float,
    plunge_stiffness: float,
    pitch_stiffness: float,
    leading_edge_mass: float = 0.0,
    sweep: float = 0.0,
    points: Array | None = None,
) -> ModalModel:
    """Clamped half wing with h = (y/s)^2 q_b + (x - x_f) (y/s) q_t, h down, theta = (y/s) q_t nose up.

    Parameters
    ----------
    semi_span, chord : float
        Length along and chord normal to the flexural axis. [m]
    flexural_axis : float
        x_f / c from the leading edge. [-]
    mass_per_area : float
        mu, uniform. [kg/m^2]
    plunge_stiffness, pitch_stiffness : float
        K_h = 4 EI/s^3 on the tip deflection, K_theta = GJ/s on the tip twist. [N/m, N m]
    leading_edge_mass : float
        Strip mass per length along the leading edge. [kg/m]
    sweep : float
        Sweep of the axis, for the grid. [rad]
    points : array_like, shape (n_points,), optional
        Distances along the axis at which shapes are wanted; the tip is added. [m]

    Returns
    -------
    modes : ModalModel
        Coordinates "bending 1" [m] and "torsion 1" [rad].

    Raises
    ------
    ValueError
        If the mass matrix is not positive definite.

    References
    ----------
    Bramstång 2015, Eqs. 7.25-7.36 and 7.41-7.42; equations.md, "Binary wing", "Moving axes".

    Examples
    --------
    >>> wing = binary_wing(semi_span=2.0, chord=0.53, flexural_axis=0.433, mass_per_area=10.0 / 1.06,
    ...                    plunge_stiffness=1644.0, pitch_stiffness=413.2)
    >>> wing.M.round(6).tolist()
    [[2.0, 0.088775], [0.088775, 0.082231]]
    """
    full = whole_aircraft(
        semi_span=semi_span,
        chord=chord,
        flexural_axis=flexural_axis,
        mass_per_area=mass_per_area,
        plunge_stiffness=plunge_stiffness,
        pitch_stiffness=pitch_stiffness,
        leading_edge_mass=leading_edge_mass,
        sweep=sweep,
        points=points,
    )
    M, D, K, phi = (np.asarray(x) for x in (full.M, full.D, full.K, full.phi))
    return ModalModel(
        M=M[:2, :2],
        D=D[:2, :2],
        K=K[:2, :2],
        names=full.names[:2],
        units=full.units[:2],
        phi=phi[..., :2],
        grid=full.grid,
    )


def whole_aircraft(
    *,
    semi_span: float,
    chord: float,
    flexural_axis: float,
    mass_per_area: float,
    plunge_stiffness: float,
    pitch_stiffness: float,
    leading_edge_mass: float = 0.0,
    centre_mass: float = 0.0,
    sweep: float = 0.0,
    points: Array | None = None,
) -> ModalModel:
    """The binary wing on a body that may heave: h gains q_h, positive down.

    Parameters
    ----------
    semi_span, chord, flexural_axis, mass_per_area, plunge_stiffness, pitch_stiffness, leading_edge_mass, sweep : float
        As in `binary_wing`. [m, m, -, kg/m^2, N/m, N m, kg/m, rad]
    centre_mass : float
        Rigid centre mass, per half, on the flexural axis. [kg]
    points : array_like, shape (n_points,), optional
        As in `binary_wing`. [m]

    Returns
    -------
    modes : ModalModel
        Coordinates "bending 1" [m], "torsion 1" [rad] and "heave" [m].

    Raises
    ------
    ValueError
        If the mass matrix is not positive definite.

    References
    ----------
    Bramstång 2015, Eqs. 7.43-7.46; equations.md, "Whole aircraft", "Moving axes".

    Examples
    --------
    >>> aircraft = whole_aircraft(semi_span=2.0, chord=0.5, flexural_axis=0.4, mass_per_area=10.0,
    ...                           plunge_stiffness=1e3, pitch_stiffness=400.0, centre_mass=3.0)
    >>> float(aircraft.M[2, 2])
    13.0
    """
    s, c, x_f, mu, m_s = semi_span, chord, flexural_axis * chord, mass_per_area, leading_edge_mass
    first, second = c**2 / 2.0 - c * x_f, c**3 / 3.0 - c**2 * x_f + c * x_f**2
    M = mu * s * np.array([[c / 5.0, first / 4.0, c / 3.0], [first / 4.0, second / 3.0, first / 2.0], [0.0, 0.0, c]])
    M += m_s * s * np.array([[0.2, -x_f / 4.0, 1.0 / 3.0], [-x_f / 4.0, x_f**2 / 3.0, -x_f / 2.0], [0.0, 0.0, 1.0]])
    M[2, :2] = M[:2, 2]
    M[2, 2] += centre_mass
    y = np.append(np.zeros(0) if points is None else np.asarray(points, dtype=float), s)
    eta, sin, cos = y / s, np.sin(sweep), np.cos(sweep)
    phi = np.zeros((len(y), 6, 3))
    phi[:, 2] = -np.stack([eta**2, 0.0 * eta, np.ones_like(eta)], axis=1)
    slope = 2.0 * eta / s
    phi[:, 3, 0], phi[:, 4, 0] = -cos * slope, sin * slope
    phi[:, 3, 1], phi[:, 4, 1] = sin * eta, cos * eta
    grid = np.stack([x_f / cos + y * sin, y * cos, 0.0 * y], axis=1)
    return ModalModel(
        M=M,
        D=np.zeros((3, 3)),
        K=np.diag([plunge_stiffness, pitch_stiffness, 0.0]),
        names=("bending 1", "torsion 1", "heave"),
        units=("m", "rad", "m"),
        phi=phi,
        grid=grid,
    )
