"""What the p, k, p-k and g methods say about one model, side by side.

On a boundary the motion is harmonic and all four solve the same equation: their crossings agree to the accuracy of the
search, unless the p method had to fit sampled air forces. Away from it each has a damping of its own. See
docs/flutter-methods.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.flutter import PK, FlutterResult, G, K, Method, P, flutter
from aeroservo.datatypes import AeroelasticModel, FlightCondition


@dataclass(frozen=True, kw_only=True)
class MethodAnswer:
    """What one method says.

    Attributes
    ----------
    method : str
        "p", "pk", "k" or "g".
    flutter_speed, flutter_frequency : float or None
        Lowest flutter. [m/s, rad/s]
    first_real_instability : float or None
        Lowest speed at which a real root becomes positive. [m/s]
    damping_before, damping_after : float or None
        Damping ratio of the flutter mode at 0.9 and 1.1 of the flutter speed of the p-k method; the k method's is
        -g/2 of its artificial damping. [-]
    fit_error : float or None
        Of the p method's fit of sampled air forces, part of the largest |Q| of a column. [-]
    refusal : str
        Why the method cannot treat the model; empty where it can.
    """

    method: str
    flutter_speed: float | None
    flutter_frequency: float | None
    first_real_instability: float | None
    damping_before: float | None
    damping_after: float | None
    fit_error: float | None
    refusal: str


def compare_methods(model: AeroelasticModel, sweep: FlightCondition) -> tuple[MethodAnswer, ...]:
    """Flutter by every method.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    sweep : FlightCondition
        Two or more ascending speeds at one density, shape (n_V,). [m/s, kg/m^3]

    Returns
    -------
    answers : tuple of MethodAnswer
        p, p-k, k, g. [m/s, rad/s]
    """
    reference = flutter(model, sweep, PK())
    answers = []
    methods: tuple[Method, ...] = (P(), PK(), K(), G())
    for method in methods:
        name = type(method).__name__.lower()
        try:
            found = reference if isinstance(method, PK) else flutter(model, sweep, method)
        except ValueError as error:
            answers.append(
                MethodAnswer(
                    method=name,
                    flutter_speed=None,
                    flutter_frequency=None,
                    first_real_instability=None,
                    damping_before=None,
                    damping_after=None,
                    fit_error=None,
                    refusal=str(error),
                )
            )
            continue
        before, after = (_damping(found, reference, factor) for factor in (0.9, 1.1))
        answers.append(
            MethodAnswer(
                method=name,
                flutter_speed=found.flutter_speed,
                flutter_frequency=found.flutter_frequency,
                first_real_instability=found.first_real_instability,
                damping_before=before,
                damping_after=after,
                fit_error=None if found.fit is None else found.fit.error,
                refusal="",
            )
        )
    return tuple(answers)


def _damping(found: FlutterResult, reference: FlutterResult, factor: float) -> float | None:
    """Damping ratio of the flutter mode at a part of the p-k flutter speed, between the points of its curve."""
    if reference.flutter_speed is None or found.flutter_mode not in found.names:
        return None
    j = found.names.index(found.flutter_mode)
    V, damping = found.speeds[:, j], found.damping_ratio[:, j]
    there = np.isfinite(V) & np.isfinite(damping)
    V, damping = V[there], damping[there]
    wanted = factor * reference.flutter_speed
    order = np.argsort(V)
    if not V.size or not V.min() <= wanted <= V.max():
        return None
    return float(np.interp(wanted, V[order], damping[order]))
