"""Misprints and unsound steps of the thesis that change a number, each with what it changes, computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aero.indicial import garrick_wagner, wagner_function
from aeroservo.aero.theodorsen import oscillatory_derivatives
from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.structure.damping import rayleigh_coefficients
from aeroservo.structure.modal import natural_modes
from aeroservo.studies.thesis_aeroelastic import Aeroelastic
from aeroservo.studies.thesis_linear import Appendix

RATIOS = (0.02, 0.03)
"""Damping ratios of the example of Rayleigh damping. [-]"""


@dataclass(frozen=True, kw_only=True)
class Misprint:
    """One of them.

    Attributes
    ----------
    where : str
        Equation, table or section.
    printed : str
        What stands there.
    right : str
        What has to.
    effect : str
        What it changes; numbers in it are computed.
    """

    where: str
    printed: str
    right: str
    effect: str


def thesis_misprints(appendix: Appendix, a: Aeroelastic) -> tuple[Misprint, ...]:
    """Everything that is put right before anything is computed.

    Parameters
    ----------
    appendix : Appendix
        Of `thesis_appendix`.
    a : Aeroelastic
        Of `thesis_aeroelastic`.

    Returns
    -------
    misprints : tuple of Misprint
        In the thesis' order.

    References
    ----------
    equations.md, errata.
    """
    return (*_of_theory(), *_of_aeroelasticity(appendix, a))


def _of_theory() -> tuple[Misprint, ...]:
    """Those of chapters 2 to 6."""
    return (
        Misprint(
            where="Table 1",
            printed="stiffnesses in kg/m and kg/rad",
            right="N/m and N m/rad",
            effect="with kilograms taken as kilopond the frequencies would be 3.13 times ours",
        ),
        _wagner(),
        Misprint(
            where="4.10",
            printed="h = + W/(24 EI)(...)",
            right="a minus for h positive down and W up",
            effect="the sign of the deflection",
        ),
        Misprint(
            where="4.19, 4.20",
            printed="C^ztheta = C^thetaz",
            right="C^ztheta(y, eta) = C^thetaz(eta, y)",
            effect="as printed the beam breaks reciprocity: work would depend on the order of loading",
        ),
        Misprint(
            where="5.17, last rows",
            printed="rows of the Euler angles out of order, sin theta for sin phi",
            right="phi' = p + (q sin phi + r cos phi) tan theta, ...",
            effect="attitudes at any bank",
        ),
        Misprint(
            where="6.11, 7.69",
            printed="u = K x",
            right="u = -K x, as in 6.8",
            effect="the loop with the sign reversed grows (Fig. 38)",
        ),
    )


def _of_aeroelasticity(appendix: Appendix, a: Aeroelastic) -> tuple[Misprint, ...]:
    """Those of chapter 7 and of the appendix."""
    return (
        Misprint(
            where="7.11",
            printed="swept divergence with a wrong sign and without a factor s",
            right="1/q = a_w (e c2 s (cos2/K_theta + sin2/K_kappa) - c s2 tan/(2 K_kappa))",
            effect=f"with stiff bending divergence rises with sweep of either sign: {a.stiff_in_bending[0]:.1f} m/s "
            "at -30 deg, "
            f"{a.divergence['section']:.1f} unswept",
        ),
        Misprint(
            where="7.16, 7.20",
            printed="signs of y phi'/V and of the entry (1,2)",
            right="minus both",
            effect="roll would lower its own damping",
        ),
        _rayleigh(),
        Misprint(
            where="7.47",
            printed="alpha_0 beside C_L0 and theta_0",
            right="C_L0 and C_M0 are the values at alpha = 0",
            effect="the trim counted twice",
        ),
        Misprint(
            where="7.53",
            printed="weight in the pitch row without cos theta",
            right="S_htheta g cos theta_0 cos theta",
            effect="the static moment of the weight at large pitch",
        ),
        _m_theta(),
        Misprint(
            where="appendix .3",
            printed="c/2U and a sign misplaced in the damping matrix",
            right="the matrices that give BACT its boundary",
            effect=f"ours put BACT at {a.bact[0]:.2f} psf; published for its inputs 149.08",
        ),
        _sign_of_a(appendix),
    )


def _wagner() -> Misprint:
    s = np.concatenate([[0.0], np.geomspace(1e-2, 1e3, 400)])
    off = float(np.abs(garrick_wagner(s) - wagner_function(s)).max())
    return Misprint(
        where="3.10",
        printed="Wagner's function as (tau + 2)/(tau + 4)",
        right="an approximation (Garrick's)",
        effect=f"off by at most {off:.4f}; it has no finite state space, so simulations here take Jones' two lags",
    )


def _rayleigh() -> Misprint:
    wa, wb = natural_modes(build(read("thesis-binary"), "quasi_steady").modes).omega[:2]
    za, zb = RATIOS
    alpha, beta = rayleigh_coefficients((float(wa), float(wb)), RATIOS)
    printed_alpha = 2.0 * wa * wb * (za * wb - zb * wa) / (wa * wb)
    printed_beta = 2.0 * (za * wa - zb * wb) / (wb**2 - wa**2)

    def ratio(x: float, y: float) -> str:
        return ", ".join(f"{x / (2.0 * w) + y * w / 2.0:+.4f}" for w in (wa, wb))

    return Misprint(
        where="7.39, 7.40",
        printed="denominator w_a w_b; numerator of beta with the opposite sign",
        right="w_b2 - w_a2 in both; beta = 2 (z_b w_b - z_a w_a)/(w_b2 - w_a2)",
        effect=f"ratios of {za:g} and {zb:g} asked for: as printed {ratio(printed_alpha, printed_beta)}, put right "
        f"{ratio(alpha, beta)}",
    )


def _m_theta() -> Misprint:
    a, k = -0.134, 0.3
    right = float(oscillatory_derivatives(k, a).M_theta)
    printed = right - np.pi * k**2 * (1.0 / 8.0 - 1.0 / 9.0)
    return Misprint(
        where="appendix .2",
        printed="1/9 in M_theta; stray factors k in M_thetadot",
        right="1/8; none",
        effect=f"M_theta at k = {k:g}, a = {a:g}: {printed:.4f} as printed, {right:.4f} put right",
    )


def _sign_of_a(appendix: Appendix) -> Misprint:
    printed = max(appendix.misprinted_roots, key=lambda s: s.real)
    right = max(appendix.open_roots, key=lambda s: s.real)
    return Misprint(
        where="appendix .4",
        printed="+1 in the first row, third column of A",
        right="-1, as in the printed A - B K",
        effect=f"least stable root {printed.real:+.3f}"
        + (f" ± {abs(printed.imag):.3f}i" if abs(printed.imag) > 1e-9 else "")
        + f" as printed, {right.real:+.3f} ± {abs(right.imag):.3f}i put right: only that oscillates as in Fig. 31",
    )
