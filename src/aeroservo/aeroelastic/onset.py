"""Where a model becomes unstable, without following its modes: for sweeps of thousands of models.

The same search on the same speeds as `flutter`, so the same numbers, without branches, names and shapes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.flutter import PK, SEARCH_POINTS, G, K, Method, P, check_sweep, prepared
from aeroservo.aeroelastic.kmethod import k_boundaries
from aeroservo.aeroelastic.pk import frequency_roots
from aeroservo.aeroelastic.roots import frequency_scale, p_values
from aeroservo.aeroelastic.stability import boundaries, unstable_counts
from aeroservo.aeroelastic.static import divergence
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition


@dataclass(frozen=True, kw_only=True)
class Onset:
    """The lowest instabilities of a model.

    Attributes
    ----------
    found : bool
        Whether any instability lies in the range of the sweep.
    flutter_speed, flutter_frequency : float or None
        Lowest crossing into an oscillatory instability; None also where one is there from the start. [m/s, rad/s]
    divergence_speed : float or None
        Static divergence, whatever the range. [m/s]
    """

    found: bool
    flutter_speed: float | None
    flutter_frequency: float | None
    divergence_speed: float | None


def onset(
    model: AeroelasticModel, sweep: FlightCondition, method: Method | None = None, *, points: int = SEARCH_POINTS
) -> Onset:
    """Lowest flutter and divergence speeds: those of `flutter`, at a fraction of its time.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    sweep : FlightCondition
        Two or more ascending speeds at one density, shape (n_V,). [m/s, kg/m^3]
    method : P, PK, K or G, optional
        How roots are found; default p-k.
    points : int
        Speeds searched beside those of the sweep. With fewer than `flutter` searches, a hump between two of them may be
        missed: a first answer, not the last word.

    Returns
    -------
    onset : Onset
        Speeds and frequency. [m/s, rad/s]

    Raises
    ------
    ValueError
        As `flutter`.

    References
    ----------
    contract.md, "flutter"; Bramstång 2015, section 7.3.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> sweep = FlightCondition(V=np.linspace(20.0, 120.0, 11), rho=1.225)
    >>> round(onset(build(read("thesis-binary")), sweep, P()).flutter_speed, 4)
    49.1632
    """
    method = method or PK()
    check_sweep(sweep)
    model, _ = prepared(model, method)
    scale = frequency_scale(model)

    def values_at(V: Array) -> Array:
        condition = FlightCondition(V=V, rho=sweep.rho[0], a_sound=sweep.a_sound[0])
        if isinstance(method, P):
            return p_values(model, condition)
        return frequency_roots(model, condition, g_method=isinstance(method, G)).values

    mesh = np.union1d(sweep.V, np.linspace(sweep.V[0], sweep.V[-1], points))
    values = values_at(mesh)
    pairs, reals = (int(count[0]) for count in unstable_counts(values[:1], scale))
    changes = boundaries(values_at, mesh, values, scale)
    if isinstance(method, K):
        found = [b for b in changes if b.kind == "real"] + k_boundaries(model, sweep)
        changes = sorted(found, key=lambda boundary: boundary.V)
    first = None if pairs else next((b for b in changes if b.kind == "oscillatory" and b.opens), None)
    return Onset(
        found=bool(pairs or reals or any(b.opens for b in changes)),
        flutter_speed=first.V if first else None,
        flutter_frequency=first.root.imag if first else None,
        divergence_speed=divergence(model, sweep[0]).V,
    )
