"""The largest gust that a closed loop still suppresses at a speed, by simulation: saturation ends what gains promise.

A 1-cosine gust counts as suppressed if no limit is left, numbers stay finite and the response dies away: its last
fifth stays below half of its peak. Amplitudes are tried upwards until one is lost, then bisected; so every smaller one
that was tried is suppressed. Noise and quantisation of sensors are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel
from aeroservo.simulate.disturbances import CosineGust
from aeroservo.simulate.engine import run_prepared
from aeroservo.simulate.outcome import main_channel
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Prepared, Scenario, Stepping
from aeroservo.studies.envelope import GustLimit

PITCH = math.radians(20.0)
"""Pitch beyond which an aircraft counts as lost. [rad]"""

PLUNGE = 3.0
"""Plunge beyond which it counts as lost. [m]"""


@dataclass(frozen=True, kw_only=True)
class GustSearch:
    """How the largest gust is sought; called with a model it gives the limits at its speeds.

    Attributes
    ----------
    speeds : tuple of float
        True airspeeds; those outside the range of the envelope are left out. [m/s]
    largest : float
        Largest amplitude tried. [m/s]
    chords : float
        Length of the gust, in reference chords (2 b). [-]
    duration : float
        Length of a run. [s]
    resolution : float
        Width to which the amplitude is bisected. [m/s]
    """

    speeds: tuple[float, ...]
    largest: float = 15.0
    chords: float = 25.0
    duration: float = 12.0
    resolution: float = 0.05

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("largest", "chords", "duration", "resolution"):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise ValueError(f"{name} of a gust search must be positive [m/s, chord, s], got {value}")

    def __call__(
        self, model: AeroelasticModel, controller: Controller | None, altitude: float, bounds: tuple[float, float]
    ) -> tuple[GustLimit, ...]:
        """Largest gust at each speed.

        Parameters
        ----------
        model : AeroelasticModel
            With rational air forces and a gust column.
        controller : Controller, optional
            Closes the loop.
        altitude : float
            Geopotential altitude. [m]
        bounds : tuple of float
            Lowest and highest speed. [m/s]

        Returns
        -------
        limits : tuple of GustLimit
            One for each speed within the bounds. [m/s]
        """
        quiet = tuple(replace(s, noise=0.0, quantum=0.0) for s in model.sensors)  # noise would hide that it dies away
        model = replace(model, sensors=quiet)
        return tuple(
            self._limit(model, controller, altitude, float(V)) for V in self.speeds if bounds[0] <= V <= bounds[1]
        )

    def _limit(self, model: AeroelasticModel, controller: Controller | None, altitude: float, V: float) -> GustLimit:
        """Tried upwards in steps of an eighth of the largest, then bisected."""
        scenario = Scenario(
            profile=level(V, altitude=altitude),
            duration=self.duration,
            controller=controller,
            gusts=(self._gust(model, self.resolution),),
        )
        ready = prepare(model, scenario, Stepping(record_s=0.01, tolerance=1e-5))
        low, high, why = 0.0, 0.0, ""
        for amplitude in (self.resolution, *np.linspace(0.0, self.largest, 9)[1:].tolist()):
            lost = self._lost(ready, model, amplitude)
            if lost:
                high, why = amplitude, lost
                break
            low = amplitude
        if not why:
            return GustLimit(speed=V, amplitude=low, at_least=True, why="")
        if low == 0.0:
            return GustLimit(speed=V, amplitude=0.0, at_least=False, why=why)
        while high - low > self.resolution:
            middle = 0.5 * (low + high)
            lost = self._lost(ready, model, middle)
            if lost:
                high, why = middle, lost
            else:
                low = middle
        return GustLimit(speed=V, amplitude=low, at_least=False, why=why)

    def _gust(self, model: AeroelasticModel, amplitude: float) -> CosineGust:
        return CosineGust(amplitude=amplitude, length=self.chords * 2.0 * model.aero.b, start=0.5)

    def _lost(self, ready: Prepared, model: AeroelasticModel, amplitude: float) -> str:
        """What was lost, "" if nothing."""
        scenario = replace(ready.scenario, gusts=(self._gust(model, amplitude),))
        run = run_prepared(replace(ready, scenario=scenario))
        if run.limit_left is not None:
            return f"{run.limit_left.channel} left its limit"
        if run.overflow_at is not None:
            return "the response ran away"
        for channel, largest in (("pitch_rad", PITCH), ("plunge_m", PLUNGE)):
            if channel in run.channels and run.peak[run.channels.index(channel)] > largest:
                return f"{channel} beyond {largest:.3g}"
        assert run.history is not None
        y = np.abs(run.history[main_channel(ready.stepper)])
        if y[4 * len(y) // 5 :].max() > 0.5 * y.max():
            return "the response does not die away"
        return ""
