"""Air forces of a rigid wing in pitch and plunge from the derivatives of the whole three-dimensional wing.

Valid for small angles and for motion slow enough that a derivative of the rate of alpha stands for the wake: reduced
frequencies omega c/(2U) below about 0.1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.datatypes import AeroInput, RationalAero, StaticLoads


@dataclass(frozen=True, kw_only=True)
class WingDerivatives:
    """Lift and moment derivatives of the whole wing, about the pitch axis, rates made with c/(2U).

    Attributes
    ----------
    S : float
        Reference area. [m^2]
    c : float
        Reference chord. [m]
    l : float
        Arm of the pitch rate in alpha = theta + h'/U + l theta'/U + w_g/U. [m]
    CL_alpha, CM_alpha, CL_delta, CM_delta : float
        Per angle of attack and per elevon. [1/rad]
    CL_q, CM_q, CL_alphadot, CM_alphadot, CL_deltadot, CM_deltadot : float
        Per theta' c/(2U), alpha' c/(2U), delta' c/(2U). [1/rad]
    CL0, CM0 : float
        At alpha = 0. [-]
    """

    S: float
    c: float
    l: float = 0.0  # noqa: E741 - the symbol of the sources
    CL_alpha: float
    CM_alpha: float
    CL_delta: float = 0.0
    CM_delta: float = 0.0
    CL_q: float = 0.0
    CM_q: float = 0.0
    CL_alphadot: float = 0.0
    CM_alphadot: float = 0.0
    CL_deltadot: float = 0.0
    CM_deltadot: float = 0.0
    CL0: float = 0.0
    CM0: float = 0.0


def derivative_air(wing: WingDerivatives) -> tuple[RationalAero, StaticLoads]:
    """Generalised air forces on plunge (down) and pitch (nose up), and the lift and pitching moment.

    With b = c/2 the factor c/(2U) of every rate is b/V, so that p = s b/V multiplies it:
    alpha = theta (1 + p l/b) + p h/b + w_g/V, and C_L = CL_alpha alpha + CL_alphadot p alpha + CL_q p theta
    + CL_delta delta + CL_deltadot p delta; C_M likewise. Forces are q_bar S [-C_L, c C_M]. The gust counts in
    alpha' as the sources have it: a sharp edge is then a jump of the rates, which linear systems and the simulation
    take exactly.

    Parameters
    ----------
    wing : WingDerivatives
        Derivatives. [1/rad]

    Returns
    -------
    aero : RationalAero
        Columns plunge, pitch, elevon (if it has derivatives), gust, and the steady ones incidence (1 rad), camber
        (CL0 and CM0). [m^2 and m^3 per unit]
    loads : StaticLoads
        "lift" (up) and "pitch" (moment about the pitch axis, nose up). [m^2 and m^3 per unit]

    References
    ----------
    Bramstång 2015, Eqs. 7.47 and 7.55-7.56, put right in equations.md, "Simulation model"; Waszak, AIAA 96-3437, 1996,
    section "Aerodynamics".

    Examples
    --------
    >>> aero, loads = derivative_air(WingDerivatives(S=2.0, c=1.0, CL_alpha=4.0, CM_alpha=0.5))
    >>> aero.A0[0, :, 1].tolist(), float(loads.row("lift")[1])
    ([-8.0, 1.0], 8.0)
    """
    b, arm = 0.5 * wing.c, wing.l / (0.5 * wing.c)

    def columns(alpha: float, alphadot: float, q: float, delta: float, deltadot: float, zero: float) -> np.ndarray:
        """Terms of p^0, p^1, p^2 in the columns h, theta, delta, w_g/V, incidence, camber: shape (3, 6)."""
        return np.array(
            [
                [0.0, alpha, delta, alpha, alpha, zero],
                [alpha / b, alpha * arm + alphadot + q, deltadot, alphadot, 0.0, 0.0],
                [alphadot / b, alphadot * arm, 0.0, 0.0, 0.0, 0.0],
            ]
        )

    w = wing
    lift = w.S * columns(w.CL_alpha, w.CL_alphadot, w.CL_q, w.CL_delta, w.CL_deltadot, w.CL0)
    moment = w.S * w.c * columns(w.CM_alpha, w.CM_alphadot, w.CM_q, w.CM_delta, w.CM_deltadot, w.CM0)
    kinds = [("plunge", "mode"), ("pitch", "mode"), ("elevon", "control"), ("gust", "gust")]
    inputs = tuple(AeroInput(name=n, kind=k) for n, k in [*kinds, ("incidence", "steady"), ("camber", "steady")])  # type: ignore[arg-type]
    A0, A1, A2 = np.stack([-lift, moment], axis=1)[:, None]
    loads = StaticLoads(names=("lift", "pitch"), Q=np.stack([lift[0], moment[0]]))
    return RationalAero(A0=A0, A1=A1, A2=A2, b=b, inputs=inputs), loads
