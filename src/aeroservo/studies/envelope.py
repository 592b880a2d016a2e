"""The envelope over speed and altitude: what the wing allows, what a controller adds, and how far that can be trusted.

Altitudes are computed one after the other and kept in a journal, so that an interruption loses nothing done. The open
loop is that of `flutter`, the closed one of `closed_flutter`; margins are disk margins of the loop as it flies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.aeroelastic.branches import Interval
from aeroservo.aeroelastic.flutter import Method, P, flutter, prepared
from aeroservo.aeroelastic.static import reversal
from aeroservo.control.closed_flutter import closed_flutter
from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.disk_margins import disk_margin
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition
from aeroservo.studies.journal import Journal
from aeroservo.studies.validity import Validity, validity

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.studies.gust_limit import GustSearch

SIX_DB = 2.0 * math.tan(math.pi / 8.0)
"""Disk margin that holds 45 deg of phase (2 tan 22.5 deg = 0.828) and with it more than 6 dB of gain. [-]"""

MARGIN_SPEEDS = 41
"""Speeds at which the margin is given."""


@dataclass(frozen=True, kw_only=True)
class GustLimit:
    """The largest gust that is still suppressed at one speed.

    Attributes
    ----------
    speed : float
        True airspeed. [m/s]
    amplitude : float
        Peak of the 1-cosine gust. [m/s]
    at_least : bool
        True where the largest gust that was tried is suppressed.
    why : str
        What is lost first beyond it; empty where nothing is.
    """

    speed: float
    amplitude: float
    at_least: bool
    why: str


@dataclass(frozen=True, kw_only=True)
class EnvelopePoint:
    """The envelope at one altitude.

    Attributes
    ----------
    altitude, density : float
        Geopotential altitude and air density. [m, kg/m^3]
    open_loop : tuple of Interval
        Unstable ranges without controller. [m/s]
    closed_loop : tuple of Interval or None
        With it; None without a controller. [m/s]
    divergence, reversal : float or None
        Static divergence; reversal of a control. [m/s]
    reversal_quantity : str or None
        What reverses: "roll" or "lift".
    margin_speed : float or None
        Highest speed to which the margin holds without a break from the lowest; None if it fails there. [m/s]
    margin_to_end : bool
        Whether it holds to the end of the range.
    margin_speeds, margin_alpha : tuple of float
        Disk margin against speed, 0 where unstable. [m/s, -]
    validity : tuple of Validity
        Where the model leaves its range. [m/s]
    gusts : tuple of GustLimit
        Largest gusts still suppressed, where asked for. [m/s]
    warnings : tuple of str
        What to know at this altitude.
    """

    altitude: float
    density: float
    open_loop: tuple[Interval, ...]
    closed_loop: tuple[Interval, ...] | None
    divergence: float | None
    reversal: float | None
    reversal_quantity: str | None
    margin_speed: float | None
    margin_to_end: bool
    margin_speeds: tuple[float, ...]
    margin_alpha: tuple[float, ...]
    validity: tuple[Validity, ...]
    gusts: tuple[GustLimit, ...]
    warnings: tuple[str, ...]

    @property
    def valid_to(self) -> Validity | None:
        """The lowest speed above which a result is not to be trusted. [m/s]"""
        above = [v for v in self.validity if v.side == "above"]
        return min(above, key=lambda v: v.speed, default=None)


def envelope(
    file: FileModel,
    altitudes: Sequence[float],
    speeds: Sequence[float],
    *,
    method: Method,
    controller: Controller | None = None,
    aero: str | None = None,
    fit_bound: float = 0.01,
    margin: float = SIX_DB,
    gusts: GustSearch | None = None,
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[EnvelopePoint, ...]:
    """Open- and closed-loop boundaries, margins, statics and validity over altitudes.

    Parameters
    ----------
    file : FileModel
        From `aeroservo.read`.
    altitudes : sequence of float
        Geopotential altitudes. [m]
    speeds : sequence of float
        True airspeeds, ascending; boundaries do not depend on their step. [m/s]
    method : P, PK, K or G
        How roots of the open loop are found; of the closed one they are eigenvalues.
    controller : Controller, optional
        Closes the loop; without it the open loop alone.
    aero : str, optional
        Air forces; by kind of model if left out.
    fit_bound : float
        Largest error of the rational fit that a closed loop needs, part of the largest |Q| of a column. [-]
    margin : float
        Balanced disk margin that is asked for. [-]
    gusts : GustSearch, optional
        Search the largest gust that is still suppressed, by simulation.
    journal : Path, optional
        Where altitudes are kept until all are done; those already there are not computed again.
    progress : callable, optional
        Called with the number of altitudes done and of all, after each.

    Returns
    -------
    points : tuple of EnvelopePoint
        One for each altitude. [SI]

    Raises
    ------
    ValueError
        If the kind of model has no envelope, a channel of the controller is missing, the margin is out of range, or
        the journal belongs to another sweep.

    References
    ----------
    contract.md, "envelope".
    """
    from aeroservo.aeroelastic.build import build

    if not 0.0 < margin < 2.0:
        raise ValueError(f"the disk margin asked for must lie between 0 and 2 [-], got {margin:g}")
    if not len(altitudes):
        raise ValueError("an envelope needs one altitude or more [m]")
    sweeps = [FlightCondition.at(float(a), V=np.asarray(speeds, dtype=float)) for a in altitudes]
    model = build(file, aero)
    alone = controller is None and gusts is None
    rational = model if alone else prepared(model, P(fit_bound=fit_bound))[0]
    if controller is not None:
        loop_plant(rational, sweeps[0][:1], controller)  # refuse before any work
    header = _header(file, altitudes, speeds, method, controller, aero, margin, gusts)
    with Journal(journal, header) as kept:
        points = [_point_of(row, journal) for row in kept.rows[: len(sweeps)]]
        for altitude, sweep in list(zip(altitudes, sweeps))[len(points) :]:
            point = _at_altitude(model, rational, float(altitude), sweep, method, controller, fit_bound, margin, gusts)
            kept.add(asdict(point))
            points.append(point)
            if progress is not None:
                progress(len(points), len(sweeps))
    return tuple(points)


def _at_altitude(
    model: AeroelasticModel,
    rational: AeroelasticModel,
    altitude: float,
    sweep: FlightCondition,
    method: Method,
    controller: Controller | None,
    fit_bound: float,
    margin: float,
    gusts: GustSearch | None,
) -> EnvelopePoint:
    """The envelope at one altitude."""
    alone = flutter(model, sweep, method)
    quantity, reverses = reversal(model, sweep[0])
    closed, notes = None, list(alone.warnings)
    speed, to_end, V, alpha = None, False, np.zeros(0), np.zeros(0)
    found: tuple[GustLimit, ...] = ()
    if controller is not None:
        loop = closed_flutter(rational, sweep, controller, fit_bound=fit_bound)
        closed, notes = loop.intervals, [*notes, *(w for w in loop.warnings if w not in notes)]
        V = np.linspace(sweep.V[0], sweep.V[-1], MARGIN_SPEEDS)
        V, alpha, speed, to_end = _margins(rational, sweep, V, controller, margin)
    if gusts is not None:
        found = gusts(rational, controller, altitude, (float(sweep.V[0]), float(sweep.V[-1])))
    return EnvelopePoint(
        altitude=altitude,
        density=float(sweep.rho[0]),
        open_loop=alone.intervals,
        closed_loop=closed,
        divergence=alone.divergence_speed,
        reversal=reverses.V,
        reversal_quantity=quantity,
        margin_speed=speed,
        margin_to_end=to_end,
        margin_speeds=tuple(V.tolist()),
        margin_alpha=tuple(alpha.tolist()),
        validity=validity(model, sweep, alone.flutter_frequency),
        gusts=found,
        warnings=tuple(notes),
    )


def _margins(
    model: AeroelasticModel, sweep: FlightCondition, V: Array, controller: Controller, margin: float
) -> tuple[Array, Array, float | None, bool]:
    """Disk margin at speeds, and the speed at which it first falls below what is asked for, to 1e-4."""

    def at(speeds: Array) -> Array:
        condition = FlightCondition(V=speeds, rho=sweep.rho[0], a_sound=sweep.a_sound[0])
        plants = loop_plant(model, condition, controller)
        return np.array(
            [disk_margin(plants[i], controller, pressure=float(q)).alpha for i, q in enumerate(condition.q)]
        )

    alpha = at(V)
    short = np.flatnonzero(alpha < margin)
    if not short.size:
        return V, alpha, float(V[-1]), True
    first = int(short[0])
    if first == 0:
        return V, alpha, None, False
    low, high = float(V[first - 1]), float(V[first])
    while high - low > 1e-4 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if at(np.array([middle]))[0] >= margin else (low, middle)
    return V, alpha, low, False


def _header(
    file: FileModel,
    altitudes: Sequence[float],
    speeds: Sequence[float],
    method: Method,
    controller: Controller | None,
    aero: str | None,
    margin: float,
    gusts: GustSearch | None,
) -> dict[str, Any]:
    """What tells one envelope from another."""
    from aeroservo.studies.boundary import model_identity

    own = None
    if controller is not None:
        own = {
            name: np.asarray(getattr(controller, name)).tolist() for name in ("A", "B", "C", "D", "pressures", "limits")
        } | {name: getattr(controller, name) for name in ("inputs", "outputs", "dt_s", "delay_s")}
    return {
        **model_identity(file),
        "study": "envelope",
        "altitudes_m": [float(a) for a in altitudes],
        "speeds_m_s": [float(v) for v in speeds],
        "method": [type(method).__name__, asdict(method)],
        "controller": own,
        "aero": aero,
        "margin": margin,
        "gusts": None if gusts is None else asdict(gusts),
    }


def _point_of(row: dict[str, Any], journal: Path | None) -> EnvelopePoint:
    """A point from its line in the journal."""
    try:
        kinds: dict[str, Callable[..., Any]] = {
            "open_loop": Interval, "closed_loop": Interval, "validity": Validity, "gusts": GustLimit,
        }  # fmt: skip
        values = dict(row)
        for name, kind in kinds.items():
            values[name] = None if row[name] is None else tuple(kind(**one) for one in row[name])
        for name in ("margin_speeds", "margin_alpha", "warnings"):
            values[name] = tuple(row[name])
        return EnvelopePoint(**values)
    except (TypeError, KeyError):
        raise ValueError(f"{journal}: is damaged; delete it or name another file to write to") from None
