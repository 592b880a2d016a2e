"""The typical section: a rigid aerofoil on springs in plunge and pitch, with or without a flap."""

from __future__ import annotations

import numpy as np

from aeroservo.datatypes import ModalModel


def typical_section(
    *,
    mass: float,
    static_moment: float,
    inertia: float,
    plunge_stiffness: float,
    pitch_stiffness: float,
    flap: tuple[float, float, float, float] | None = None,
) -> ModalModel:
    """Two or three degrees of freedom per metre of span, about the flexural axis.

    Parameters
    ----------
    mass : float
        Mass. [kg/m]
    static_moment : float
        m x_alpha b, positive for a centre of gravity aft of the axis. [kg]
    inertia : float
        Moment of inertia about the flexural axis. [kg m]
    plunge_stiffness, pitch_stiffness : float
        Springs. [N/m^2, N]
    flap : tuple of float, optional
        Distance of the hinge aft of the flexural axis [m], static moment [kg] and inertia [kg m] of the flap
        about its hinge, stiffness of the hinge [N].

    Returns
    -------
    modes : ModalModel
        Coordinates "plunge" (down), "pitch" (nose up) and "flap" (trailing edge down, relative); one grid
        point, one metre off the plane of symmetry. [per metre of span]

    Raises
    ------
    ValueError
        If the mass matrix is not positive definite.

    References
    ----------
    Theodorsen, NACA Report 496, 1935, Eqs. I-III; Bramstång 2015, section 7.3.

    Examples
    --------
    >>> section = typical_section(mass=10.0, static_moment=1.0, inertia=0.5, plunge_stiffness=1e4, pitch_stiffness=1e3)
    >>> section.M.tolist()
    [[10.0, 1.0], [1.0, 0.5]]
    """
    n = 2 if flap is None else 3
    M, K = np.zeros((n, n)), np.zeros((n, n))
    M[:2, :2] = [[mass, static_moment], [static_moment, inertia]]
    K[0, 0], K[1, 1] = plunge_stiffness, pitch_stiffness
    if flap is not None:
        arm, flap_moment, flap_inertia, K[2, 2] = flap
        M[2] = M[:, 2] = flap_moment, flap_inertia + arm * flap_moment, flap_inertia
    phi = np.zeros((1, 6, n))
    phi[0, 2, 0], phi[0, 4, 1] = -1.0, 1.0
    names, units = ("plunge", "pitch", "flap")[:n], ("m", "rad", "rad")[:n]
    return ModalModel(M=M, D=np.zeros((n, n)), K=K, names=names, units=units, phi=phi, grid=np.array([[0.0, 1.0, 0.0]]))
