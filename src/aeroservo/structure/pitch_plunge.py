"""The rigid wing on a plunge and a pitch spring of wind-tunnel mounts (BACT) and of the thesis' simulation."""

from __future__ import annotations

import numpy as np

from aeroservo.datatypes import ModalModel


def pitch_plunge(
    *,
    mass: float,
    static_moment: float,
    inertia: float,
    plunge_stiffness: float,
    pitch_stiffness: float,
    plunge_damping: float = 0.0,
    pitch_damping: float = 0.0,
    control_moments: tuple[float, float] = (0.0, 0.0),
) -> ModalModel:
    """Structure of the pitch-plunge model, with the damping of the thesis.

    Damping is D = M diag(2 zeta_h omega_h, 2 zeta_theta omega_theta) with the uncoupled frequencies
    omega_h = sqrt(K_h/m) and omega_theta = sqrt(K_theta/I_theta). Where the static moment is not zero that
    matrix is not symmetric: it is kept because BACT's published flutter pressure stands on it.

    Parameters
    ----------
    mass : float
        Mass. [kg]
    static_moment : float
        S_htheta about the pitch axis, positive for a centre of gravity aft of it. [kg m]
    inertia : float
        Moment of inertia about the pitch axis. [kg m^2]
    plunge_stiffness, pitch_stiffness : float
        Springs. [N/m, N m/rad]
    plunge_damping, pitch_damping : float
        zeta_h and zeta_theta. [-]
    control_moments : tuple of float, length 2
        Inertia coupling S_hdelta [kg m] and S_thetadelta [kg m^2] of one elevon.

    Returns
    -------
    modes : ModalModel
        Coordinates "plunge" (down, of the pitch axis) and "pitch" (nose up); one grid point. [SI]

    Raises
    ------
    ValueError
        If the mass matrix is not positive definite.

    References
    ----------
    Bramstång 2015, Eqs. 7.52-7.53 and 7.57; Waszak, AIAA 96-3437, 1996, section "Equations of motion".

    Examples
    --------
    >>> bact = pitch_plunge(mass=2.0, static_moment=0.0, inertia=1.0, plunge_stiffness=8.0, pitch_stiffness=9.0,
    ...                     plunge_damping=0.1)
    >>> bact.D.round(9).tolist()
    [[0.8, 0.0], [0.0, 0.0]]
    """
    M = np.array([[mass, static_moment], [static_moment, inertia]])
    rates = 2.0 * np.array(
        [plunge_damping * np.sqrt(plunge_stiffness / mass), pitch_damping * np.sqrt(pitch_stiffness / inertia)]
    )
    phi = np.zeros((1, 6, 2))
    phi[0, 2, 0], phi[0, 4, 1] = -1.0, 1.0
    return ModalModel(
        M=M,
        D=M * rates,
        K=np.diag([plunge_stiffness, pitch_stiffness]),
        names=("plunge", "pitch"),
        units=("m", "rad"),
        M_control=np.array(control_moments)[:, None],
        phi=phi,
        grid=np.zeros((1, 3)),
    )
