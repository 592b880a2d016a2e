"""Everything that a report on one model needs, computed when it is first asked for, each thing once.

`ReportCase` holds the results and knows nothing of pages; `report/` turns them into parts. Reference conditions, where
the user names none: time histories at nine tenths of the first oscillatory instability and at eleven tenths of it, wing
polars at the speed at which a lift coefficient of 0.3, or less where section polars ask for it, carries the weight.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from aeroservo.aero.rational import fit_rational
from aeroservo.aeroelastic.build import DEFAULTS, build
from aeroservo.aeroelastic.flutter import PK, FlutterResult, G, K, P, flutter
from aeroservo.aeroelastic.static import StaticResult, static
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.files import read
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_other import StateSpaceFile
from aeroservo.atmosphere import STANDARD_GRAVITY, atmosphere
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.control.plant import chosen
from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem, SampledAero
from aeroservo.simulate.disturbances import CosineGust, Gustiness
from aeroservo.simulate.engine import Simulation, simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.structure.modal import NaturalModes, natural_modes
from aeroservo.studies.aero_views import WingCase
from aeroservo.studies.aircraft_aero import kinematic_viscosity
from aeroservo.studies.input_hash import input_hash
from aeroservo.studies.live_model import LiveFamily, live_family

MACH_LIMIT = 0.3
"""Beyond it incompressible theory is said to err."""
GUST_ANGLE = np.radians(1.0)
"""Gust velocity over airspeed in time histories: small, so that linear theory holds."""
CRUISE_LIFTS = (0.3, 0.25, 0.2, 0.15, 0.1)
"""Lift coefficients of wing polars, trim and span loading, the first for which section polars reach. [-]"""
GROWN = 2.0
"""Growth, as a power of e, after which a run beyond flutter ends."""
MOST_SPEEDS = 400
"""Speeds of the sweep that figures draw; boundaries do not depend on them."""
METHODS: dict[str, type[P] | type[PK] | type[K] | type[G]] = {"p": P, "pk": PK, "k": K, "g": G}


@dataclass(frozen=True, kw_only=True, eq=False)
class ReportOptions:
    """What the user asked for.

    Attributes
    ----------
    altitude : float
        Geopotential altitude. [m]
    aero : str, optional
        Air forces; by kind of model if not given.
    speed : float, optional
        Airspeed of time histories and gusts. [m/s]
    controller : Controller, optional
        Closes the loop instead of the report's own regulator.
    controller_name : str
        Of its file.
    """

    altitude: float = 0.0
    aero: str | None = None
    speed: float | None = None
    controller: Controller | None = None
    controller_name: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """One time history with its conditions.

    Attributes
    ----------
    name : str
        For headings.
    words : str
        What happens in it.
    V : float
        True airspeed. [m/s]
    found : Simulation
        With its history.
    closed : bool
        Whether a controller flies.
    """

    name: str
    words: str
    V: float
    found: Simulation
    closed: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class ReportCase:
    """A model file, what was asked for, and every result, computed at first use.

    Attributes
    ----------
    file : FileModel
        From `aeroservo.read`.
    options : ReportOptions
        Conditions.
    """

    file: FileModel
    options: ReportOptions

    @cached_property
    def model(self) -> AeroelasticModel:
        """The coupled model. [SI]"""
        return build(self.file, self.options.aero)

    @cached_property
    def rational(self) -> AeroelasticModel:
        """The model with air forces that have a state space.

        Returns
        -------
        model : AeroelasticModel
            Samples fitted, hysteretic damping left out. [SI]

        Raises
        ------
        ValueError
            If the fit is worse than a hundredth.
        """
        if not isinstance(self.model.aero, SampledAero):
            return self.model
        fit = fit_rational(self.model.aero)
        if fit.error > 0.01:
            raise ValueError(f"rational air forces miss the samples by {100.0 * fit.error:.2g} %, more than 1 %")
        return replace(self.model, aero=fit.aero, modes=replace(self.model.modes, hysteretic_g=0.0))

    @cached_property
    def air(self) -> Any:
        """Density, temperature, speed of sound at the altitude. [kg/m^3, K, m/s]"""
        return atmosphere(self.options.altitude)

    @property
    def rho(self) -> float:
        """Density. [kg/m^3]"""
        return float(self.air.rho)

    @property
    def a_sound(self) -> float:
        """Speed of sound. [m/s]"""
        return float(self.air.a_sound)

    @cached_property
    def sweep(self) -> FlightCondition:
        """Speeds that figures draw. [m/s]"""
        low, high, step = self.file.speeds_m_s or (1.0, 350.0, 1.0)
        count = min(MOST_SPEEDS, max(2, round((high - low) / step) + 1))
        return FlightCondition.at(self.options.altitude, V=np.linspace(low, max(high, low * (1.0 + 1e-6)), count))

    @cached_property
    def method(self) -> P | PK | K | G:
        """Method of flutter: the kind's own, p-k for sampled air forces. [-]"""
        usual = "pk" if self.options.aero == "theodorsen" else DEFAULTS[self.file.kind].method
        return METHODS[usual]()

    @property
    def theory(self) -> str:
        """Air forces in force, by name. [-]"""
        return self.options.aero or DEFAULTS[self.file.kind].aero or "the model's own"

    @cached_property
    def found(self) -> FlutterResult:
        """Flutter over the sweep. [SI]"""
        return flutter(self.model, self.sweep, self.method)

    @cached_property
    def static(self) -> StaticResult:
        """Statics over the sweep. [SI]"""
        return static(self.model, self.sweep)

    @cached_property
    def natural(self) -> NaturalModes:
        """Modes without air. [rad/s]"""
        return natural_modes(self.model.modes)

    @cached_property
    def onset(self) -> float | None:
        """Lowest speed of any instability: oscillatory, real, or static divergence. [m/s]"""
        speeds = [self.found.flutter_speed, self.found.first_real_instability, self.found.divergence_speed]
        return min((v for v in speeds if v is not None), default=None)

    @property
    def speed(self) -> float:
        """Airspeed of time histories and gusts. [m/s]"""
        if self.options.speed is not None:
            return self.options.speed
        V = self.sweep.V
        first = self.found.flutter_speed or self.onset
        middle = min(0.6 * float(V[-1]), MACH_LIMIT * self.a_sound)
        return float(np.clip(middle if first is None else 0.9 * first, V[0], V[-1]))

    @property
    def frequency(self) -> float:
        """Frequency that time scales follow: of flutter, else of the lowest elastic mode. [Hz]"""
        elastic = self.natural.omega[self.natural.omega > 0.0]
        omega = self.found.flutter_frequency or (float(elastic[0]) if elastic.size else 1.0)
        return omega / (2.0 * np.pi)

    @cached_property
    def wing(self) -> tuple[float, WingCase]:
        """Wing polars of an aircraft.

        Returns
        -------
        CL, case : float, WingCase
            Lift coefficient that carries the weight at the speed of the polars: the first of a few for which section
            polars reach. [-, SI]

        Raises
        ------
        ValueError
            If this is no aircraft with airfoils.
        """
        if not isinstance(self.file, AircraftFile):
            raise ValueError(f"a model of kind {self.file.kind} has no airfoils: wing polars need kind 'aircraft'")
        masses, S = self.file.masses(), self.file.references().S
        first: ValueError | None = None
        for CL in CRUISE_LIFTS:
            weight = np.nan if masses is None else masses.mass * STANDARD_GRAVITY
            case = WingCase(
                model=self.file,
                alpha=np.radians(np.arange(-4.0, 12.5, 1.0)),
                delta=np.radians([-5.0, 0.0, 5.0]),
                speed=25.0 if masses is None else float(np.sqrt(2.0 * weight / (self.rho * S * CL))),
                viscosity=kinematic_viscosity(self.options.altitude),
            )
            try:
                _ = case.sections
            except ValueError as error:
                first = first or error
                continue
            return CL, case
        raise ValueError(str(first))

    @cached_property
    def family(self) -> LiveFamily:
        """Linear models over speed, density and torsional stiffness, with a regulator's gains. [SI]"""
        V = self.sweep.V
        top = min(1.5 * (self.onset or 0.67 * float(V[-1])), float(V[-1]))
        low = max(float(V[0]), 0.2 * top)
        high = max(self.options.altitude, 8000.0)
        thin = float(atmosphere(min(high, 11000.0)).rho)
        dense = max(float(atmosphere(0.0).rho), self.rho)
        return live_family(self.file, self.model, V=(low, top), rho=(thin, dense), rate_Hz=self.rate)

    @property
    def rate(self) -> float:
        """Sample rate of the report's own regulator: twenty times the frequency that matters, round. [Hz]"""
        return float(np.clip(np.ceil(20.0 * self.frequency / 50.0) * 50.0, 50.0, 2000.0))

    @property
    def controllable(self) -> bool:
        """Whether the report's own regulator has a control to move and a tip to look at. [-]"""
        return bool(self.model.columns("control")) and len(self.model.modes.grid) > 0

    def plant(self, V: float) -> LinearSystem:
        """Controls to states at an airspeed [m/s], the plant of the report's own regulator. [SI]"""
        family = self.family
        return chosen(family.at(V, self.rho), inputs=family.inputs[: family.controls], outputs=None)

    def regulator(self, V: float) -> Controller:
        """State feedback of the schedule at an airspeed [m/s]. [SI]"""
        family = self.family
        K = family.gain(0.5 * self.rho * V * V)
        return state_feedback(K, family.states, family.inputs[: family.controls], family.dt_s)

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """Time histories: a gust below and above the boundary, the loop open and closed, and turbulence.

        Returns
        -------
        runs : tuple of Run
            Each with its history. [SI]

        Raises
        ------
        ValueError
            If nothing disturbs the model.
        """
        return tuple(_runs(self))

    @cached_property
    def input_hash(self) -> str:
        """SHA-256 of model and options in a canonical form, the same on every machine. [-]"""
        c, o = self.options.controller, self.options
        laws = None if c is None else [np.asarray(x).tolist() for x in (c.A, c.B, c.C, c.D)]
        asked = {"altitude_m": o.altitude, "aero": o.aero, "speed_m_s": o.speed, "controller": laws}
        if c is not None:
            asked["held"] = [c.dt_s, c.delay_s, list(c.limits), np.asarray(c.pressures).tolist()]
        return input_hash(self.file, asked)


def report_case(name: str | Path, options: ReportOptions) -> ReportCase:
    """A model ready to be reported on.

    Parameters
    ----------
    name : str or Path
        Preset or file.
    options : ReportOptions
        Conditions.

    Returns
    -------
    case : ReportCase
        Nothing is computed yet. [SI]
    """
    return ReportCase(file=read(name), options=options)


def _runs(case: ReportCase) -> list[Run]:
    """Time histories by kind of model."""
    if isinstance(case.file, StateSpaceFile):
        return []
    if not case.model.columns("gust"):
        raise ValueError("the air forces have no gust column: nothing disturbs this model")
    below, f = case.speed, case.frequency
    first = case.found.flutter_speed
    length = max(below / f, 4.0 * case.model.aero.b)
    duration = float(np.clip(14.0 / f, 0.5, 30.0))
    out = [_gusted(case, below, length, duration, "Gust, loop open")]
    if first is not None and case.options.speed is None:
        here = case.found.roots[int(np.argmin(np.abs(case.sweep.V - 1.1 * first)))].real
        growth = float(np.nanmax(here)) if np.any(np.isfinite(here)) else 0.0
        short = float(np.clip(0.05 * duration + length / first + GROWN / max(growth, 1e-9), 0.2 * duration, duration))
        out.append(_gusted(case, 1.1 * first, length, short, "Gust beyond flutter, loop open"))
    if case.options.controller is not None or case.controllable:
        fast = 1.1 * first if first is not None and case.options.speed is None else below
        out.append(_gusted(case, fast, length, duration, "Gust, loop closed", closed=True))
    out.append(_turbulent(case, below, 4.0 * duration))
    return out


def _gusted(case: ReportCase, V: float, length: float, duration: float, name: str, *, closed: bool = False) -> Run:
    """A 1-cosine gust that tunes with the mode."""
    amplitude = float(np.tan(GUST_ANGLE)) * V
    gust = CosineGust(amplitude=amplitude, length=length, start=0.05 * duration)
    found = _flown(case, V, duration, closed=closed, gusts=(gust,))
    words = f"1-cosine gust of {amplitude:.3g} m/s up, {length:.3g} m long, at {V:.4g} m/s"
    return Run(name=name, words=words, V=V, found=found, closed=closed)


def _turbulent(case: ReportCase, V: float, duration: float) -> Run:
    """Dryden turbulence of 1 m/s."""
    closed = case.options.controller is not None
    found = _flown(case, V, duration, closed=closed, turbulence=Gustiness(level=1.0))
    words = (
        f"Dryden turbulence of 1 m/s RMS (L = 533.4 m), seed 1, at {V:.4g} m/s, loop {'closed' if closed else 'open'}"
    )
    return Run(name="Turbulence", words=words, V=V, found=found, closed=closed)


def _flown(case: ReportCase, V: float, duration: float, *, closed: bool, **what: Any) -> Simulation:
    """Run the model with its nonlinearities; the report's own regulator flies the linear one, whose states it reads."""
    own = closed and case.options.controller is None
    model: AeroelasticModel | LinearSystem = case.family.at(V, case.rho) if own else case.rational
    controller = None if not closed else case.regulator(V) if own else case.options.controller
    scenario = Scenario(
        profile=level(V, altitude=case.options.altitude), duration=duration, controller=controller, **what
    )
    return simulate(model, scenario, seed=1, stepping=Stepping(record_s=duration / 1500.0))
