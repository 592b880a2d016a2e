"""Damping of the whole aircraft over speed and altitude, or over speed and pitch stiffness: thesis Figs 29 and 30."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aeroservo.aeroelastic.flutter import P
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition
from aeroservo.studies.boundary import Over
from aeroservo.studies.surface import DampingSurface, damping_surface
from aeroservo.studies.thesis import ALTITUDES


def thesis_surface(field: str, *, points: int = 21) -> DampingSurface:
    """Damping of the whole aircraft over speed and one more number, as in the thesis' Figs 29 and 30.

    Parameters
    ----------
    field : {"altitude_m", "wing.pitch_stiffness_N_m"}
        What varies: 0 to 10,000 m, or 200 to 800 N m at 10,000 ft.
    points : int
        Values of it.

    Returns
    -------
    surface : DampingSurface
        Of the least damped oscillation at each point, whichever mode it is (the thesis shows "the mode causing
        flutter"; names change hands where two modes veer). Quasi-steady with pitch damping, p method, 1 to 130
        m/s. [-, rad/s]

    References
    ----------
    Bramstång 2015, section 9.3.3, Figs 29-30; the ranges are ours, the thesis prints none in its text.

    Examples
    --------
    >>> thesis_surface("altitude_m", points=2).damping_ratio.shape[0]
    2
    """
    low, high = {"altitude_m": (0.0, 10000.0), "wing.pitch_stiffness_N_m": (200.0, 800.0)}[field]
    over = Over(field=field, values=tuple(np.linspace(low, high, points)))
    sweep = FlightCondition.at(ALTITUDES[-1], V=np.arange(1.0, 131.0, 2.0))
    surface = damping_surface(read("thesis-aircraft"), over, sweep, P(), aero="quasi_steady_damped")
    elastic = [j for j, name in enumerate(surface.names) if name != "heave"]
    damping, frequency = surface.damping_ratio[..., elastic], surface.frequency[..., elastic]
    least = np.argmin(np.where(np.isfinite(damping), damping, np.inf), axis=2)[..., None]
    return replace(
        surface,
        names=("least damped mode",),
        damping_ratio=np.take_along_axis(damping, least, axis=2),
        frequency=np.take_along_axis(frequency, least, axis=2),
    )
