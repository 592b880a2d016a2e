"""Chapters 7, 9.2 and 9.3 of the thesis again: divergence, flutter and their mechanisms, what changes the boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.closed_form import (
    UniformWing,
    binary_divergence_pressure,
    section_divergence_pressure,
    swept_divergence_pressure,
    wing_divergence_pressure,
)
from aeroservo.aeroelastic.flutter import PK, P, flutter
from aeroservo.aeroelastic.linear import state_matrix
from aeroservo.aeroelastic.static import static
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition
from aeroservo.studies.surface import DampingSurface
from aeroservo.studies.thesis import ALTITUDES, MODELS, Model, ThesisStudy, thesis_model, thesis_study
from aeroservo.studies.thesis_surface import thesis_surface

HIGH = ALTITUDES[-1]
SWEEPS = (-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0)
"""Of the rigid wing on root springs. [deg]"""
SURFACES = ("altitude_m", "wing.pitch_stiffness_N_m")


@dataclass(frozen=True, kw_only=True, eq=False)
class Aeroelastic:
    """Everything that chapters 7, 9.2 and 9.3 rest on; speeds at 10,000 ft unless told.

    Attributes
    ----------
    study : ThesisStudy
        Tables 2 and 3, runs, curves over a held k.
    surfaces : dict of str to DampingSurface
        Figures 29 and 30.
    divergence : dict of str to float
        Sea level: "section" on a spring, "linear twist", "uniform beam". [m/s]
    swept : ndarray, shape (n,)
        Divergence of a rigid wing on root springs over `SWEEPS`, nan where there is none, sea level. [m/s]
    stiff_in_bending : ndarray, shape (n,)
        The same with bending infinitely stiff. [m/s]
    motion : tuple of float
        Bending of the tip over c times its twist, and the phase of the twist behind the bending at flutter of the
        binary wing. [-, rad]
    equal_slope : dict of (str, float) to float
        Quasi-steady flutter with the lift slope of the thin aerofoil, 2 pi, by model and altitude [m]. [m/s]
    without_rate : float
        Flutter of the binary wing without M_thetadot, sea level. [m/s]
    damped : dict of (str, float) to float
        Flutter of binary wing and whole aircraft by Theodorsen p-k with hysteretic damping g. [m/s]
    plunge : ndarray, shape (n, 2)
        Plunge stiffness [N/m] and flutter speed [m/s] of the whole aircraft.
    wing_sweep : ndarray, shape (n, 2)
        Sweep [deg] and flutter speed [m/s] of the binary wing.
    bact : tuple of float
        Flutter of the BACT model: dynamic pressure [psf] and frequency [Hz].
    simulation : dict of float to tuple
        Flutter, divergence and lift reversal of the simulation model by altitude. [m/s]
    uav : dict of float to tuple
        Flutter by Theodorsen p-k, divergence and roll reversal of the wing as drawn, by altitude. [m/s]
    relief : tuple of float
        Roll effectiveness of the wing as drawn at 60 m/s: rigid in bending, rigid in torsion, both elastic. [-]
    """

    study: ThesisStudy
    surfaces: dict[str, DampingSurface]
    divergence: dict[str, float]
    swept: Array
    stiff_in_bending: Array
    motion: tuple[float, float]
    equal_slope: dict[tuple[Model, float], float]
    without_rate: float
    damped: dict[tuple[Model, float], float | None]
    plunge: Array
    wing_sweep: Array
    bact: tuple[float, float]
    simulation: dict[float, tuple[float | None, float | None, float | None]]
    uav: dict[float, tuple[float | None, float | None, float | None]]
    relief: tuple[float, float, float]

    def flutter(self, model: Model, altitude: float, theory: str = "quasi_steady_damped", slope: str = "a_w") -> float:
        """Flutter speed of a run; nan without flutter. [m/s]"""
        found = self.study.run(model, altitude, theory, slope).flutter.flutter_speed  # type: ignore[arg-type]
        return float("nan") if found is None else found


def thesis_aeroelastic(
    *,
    speeds: Array | None = None,
    k: Array | None = None,
    points: int = 21,
    progress: Callable[[str], None] | None = None,
) -> Aeroelastic:
    """The wing's divergence and flutter by every model, and what moves them.

    Parameters
    ----------
    speeds : ndarray, shape (n_V,), optional
        Sweep of the tables' runs. [m/s]
    k : ndarray, shape (n_k,), optional
        Reduced frequencies of the held derivatives. [-]
    points : int
        Values of the other number of Figures 29 and 30.
    progress : callable, optional
        Told in words what comes next.

    Returns
    -------
    aeroelastic : Aeroelastic
        Runs and numbers. [SI]

    References
    ----------
    Bramstång 2015, chapters 7, 9.2, 9.3.
    """
    say = progress or (lambda words: None)
    study = thesis_study(speeds=speeds, k=k, progress=progress)
    say("what moves flutter: altitude, stiffness, damping, sweep")
    swept, stiff = _swept()
    slopes = {(m, h): _flutter(thesis_model(m, "quasi_steady_damped", "2 pi"), h) or np.nan
              for m in MODELS for h in ALTITUDES}  # fmt: skip
    return Aeroelastic(
        study=study,
        surfaces={field: thesis_surface(field, points=points) for field in SURFACES},
        divergence=_divergence(),
        swept=swept,
        stiff_in_bending=stiff,
        motion=_motion(study),
        equal_slope=slopes,
        without_rate=_flutter(build(read("thesis-binary"), "quasi_steady"), 0.0) or np.nan,
        damped={(m, g): _damped(m, g) for m in MODELS for g in (0.0, 0.02, 0.05)},
        plunge=_varied("thesis-aircraft", "wing.plunge_stiffness_N_per_m", (400.0, 822.0, 1644.0, 3288.0, 6576.0)),
        wing_sweep=_varied("thesis-binary", "wing.sweep_deg", (0.0, 15.0, 30.0, 45.0)),
        bact=_bact(),
        simulation={h: _simulation_speeds(h) for h in ALTITUDES},
        uav={h: _uav_speeds(h) for h in ALTITUDES},
        relief=_relief(),
    )


def _sweep(altitude: float, last: float = 150.0) -> FlightCondition:
    """A coarse sweep: boundaries are refined whatever its step."""
    return FlightCondition.at(altitude, V=np.arange(5.0, last + 1.0, 5.0))


def _flutter(model: AeroelasticModel, altitude: float) -> float | None:
    """Flutter speed by p."""
    return flutter(model, _sweep(altitude), P()).flutter_speed


def _varied(preset: str, field: str, values: tuple[float, ...]) -> Array:
    """Flutter against one number of a preset, quasi-steady, 10,000 ft."""
    file = read(preset)
    speeds = [_flutter(build(override(file, {field: v}), "quasi_steady_damped"), HIGH) for v in values]
    return np.array([[v, np.nan if s is None else s] for v, s in zip(values, speeds)])


def _damped(model: Model, g: float) -> float | None:
    """Theodorsen p-k with hysteretic damping, 10,000 ft."""
    exact = thesis_model(model, "theodorsen")
    damped = replace(exact, modes=replace(exact.modes, hysteretic_g=g))
    return flutter(damped, _sweep(HIGH, 120.0), PK()).flutter_speed


def binary_in_closed_form() -> UniformWing:
    """The binary wing of Tables 2 and 3 as a uniform wing of closed formulas.

    Returns
    -------
    wing : UniformWing
        Preset `thesis-binary`. [SI]
    """
    file: Any = read("thesis-binary")
    w, d = file.wing, file.derived()
    return UniformWing(
        GJ=d["GJ_N_m2"], eccentricity=d["eccentricity"], chord=w.chord_m, semi_span=w.semi_span_m,
        lift_slope=w.lift_slope_per_rad,
    )  # fmt: skip


def _springs() -> tuple[float, float]:
    """Pitch and plunge stiffness of the binary wing."""
    file: Any = read("thesis-binary")
    return file.wing.pitch_stiffness_N_m, file.wing.plunge_stiffness_N_per_m


def _speed(q: float | None, altitude: float = 0.0) -> float:
    """Speed at a dynamic pressure; nan where there is none."""
    return float("nan") if q is None else float(np.sqrt(2.0 * q / FlightCondition.at(altitude, V=1.0).rho))


def _divergence() -> dict[str, float]:
    """Three readings of the same numbers, sea level."""
    wing = binary_in_closed_form()
    section = section_divergence_pressure(
        pitch_stiffness=_springs()[0], eccentricity=wing.eccentricity, chord=wing.chord, span=wing.semi_span,
        lift_slope=wing.lift_slope,
    )  # fmt: skip
    return {
        "section": _speed(section),
        "linear twist": _speed(binary_divergence_pressure(wing)),
        "uniform beam": _speed(wing_divergence_pressure(wing)),
    }


def _swept() -> tuple[Array, Array]:
    """Rigid wing on root springs: twist K_theta, bending K_h s^2; then with rigid bending."""
    wing, (K_theta, K_h) = binary_in_closed_form(), _springs()
    rows = []
    for bending in (K_h * wing.semi_span**2, np.inf):
        rows.append(
            [
                _speed(
                    swept_divergence_pressure(
                        pitch_stiffness=K_theta, bending_stiffness=bending, eccentricity=wing.eccentricity,
                        chord=wing.chord, span=wing.semi_span, lift_slope=wing.lift_slope, sweep=float(np.radians(x)),
                    )
                )
                for x in SWEEPS
            ]
        )  # fmt: skip
    return np.array(rows[0]), np.array(rows[1])


def _motion(study: ThesisStudy) -> tuple[float, float]:
    """Shape of the flutter motion of the binary wing, quasi-steady, 10,000 ft."""
    found = study.run("binary", HIGH, "quasi_steady_damped").flutter
    model = thesis_model("binary", "quasi_steady_damped")
    condition = FlightCondition.at(HIGH, V=found.flutter_speed or 1.0)
    values, vectors = np.linalg.eig(state_matrix(model, condition))
    bend, twist = vectors[:2, int(np.argmin(np.abs(values - 1j * (found.flutter_frequency or 0.0))))]
    chord = 2.0 * model.aero.b
    return float(abs(bend) / abs(chord * twist)), float(np.angle(bend / twist))


def _bact() -> tuple[float, float]:
    """Flutter of BACT at the density of its tunnel."""
    found = flutter(build(read("bact")), FlightCondition(V=np.arange(20.0, 200.0, 5.0), rho=np.array(1.01628)), P())
    V, omega = found.flutter_speed or np.nan, found.flutter_frequency or np.nan
    return 0.5 * 1.01628 * V**2 / 47.880259, omega / (2.0 * np.pi)


def _simulation_speeds(altitude: float) -> tuple[float | None, float | None, float | None]:
    """Open-loop boundaries of the simulation model."""
    model, sweep = build(read("thesis-simulation")), _sweep(altitude)
    found, rest = flutter(model, sweep, P()), static(model, sweep)
    return found.flutter_speed, rest.divergence.V, rest.reversal.V


def _uav_speeds(altitude: float) -> tuple[float | None, float | None, float | None]:
    """Boundaries of the wing as drawn, its stiffnesses those of Table 1 at the tip of a half wing of 1 m."""
    model, sweep = build(read("thesis-uav")), _sweep(altitude)
    found, rest = flutter(model, sweep, PK()), static(model, sweep)
    return found.flutter_speed, rest.divergence.V, rest.reversal.V


def _relief() -> tuple[float, float, float]:
    """Roll effectiveness at 60 m/s with bending or torsion made stiff."""
    file: Any = read("thesis-uav")
    found = []
    for stiff in ("EI_N_m2", "GJ_N_m2", ""):
        change = {f"structure.station[{i}].{stiff}": 1e7 for i in range(len(file.structure.station)) if stiff}
        found.append(float(static(build(override(file, change)), FlightCondition.at(HIGH, V=[60.0])).effectiveness[0]))
    return found[0], found[1], found[2]
