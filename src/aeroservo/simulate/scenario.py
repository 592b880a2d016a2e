"""What is simulated and how: a flight with its disturbances, the step, and both made ready for the compiled engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from aeroservo.control.adaptive import Adaptation
from aeroservo.control.controller import Controller
from aeroservo.datatypes import Array
from aeroservo.simulate.assemble import Stepper
from aeroservo.simulate.disturbances import CosineGust, Doublet, Gustiness, SharpGust
from aeroservo.simulate.profiles import Profile


@dataclass(frozen=True, kw_only=True)
class Stepping:
    """How a run is stepped and what of it is kept.

    Attributes
    ----------
    dt : float, optional
        Base step wanted; a smaller one is taken where the controller's sample asks for it. Default 1 ms. [s]
    substeps : int, optional
        Runge-Kutta steps in a base step; default by the fastest mode and the halving check.
    method : {"auto", "rk4", "exact"}
        "auto" is exact where the model allows it.
    tolerance : float
        Largest difference between a step and its half over the halving check, part of each state's largest value;
        1e-5 at least is taken for models with clips, play, gaps or tables. [-]
    record_s : float, optional
        Step of the history; default about 20,000 samples in a run. [s]
    history : bool
        Whether a history is kept: without it memory does not grow with the run.
    """

    dt: float | None = None
    substeps: int | None = None
    method: Literal["auto", "rk4", "exact"] = "auto"
    tolerance: float = 1e-7
    record_s: float | None = None
    history: bool = True

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("dt", "record_s", "tolerance", "substeps"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < np.inf:
                raise ValueError(f"{name} of stepping must be positive [s or -], got {value}")
        if self.method not in ("auto", "rk4", "exact"):
            raise ValueError(f"method of stepping must be auto, rk4 or exact, got {self.method!r}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenario:
    """A flight and everything that happens in it.

    Attributes
    ----------
    profile : Profile
        Airspeed and altitude.
    duration : float
        Length of the run. [s]
    controller : Controller, optional
        Closes the loop.
    adaptation : Adaptation, optional
        Identifies the controls while the controller flies, and scales its commands.
    gusts : tuple of SharpGust or CosineGust
        Discrete gusts.
    doublets : tuple of Doublet
        Commands from outside.
    turbulence : Gustiness, optional
        Continuous turbulence.
    initial : tuple of (str, float)
        States at the start, from the equilibrium, by name: ("pitch_rad", 0.01). [unit of the state]
    """

    profile: Profile
    duration: float
    controller: Controller | None = None
    adaptation: Adaptation | None = None
    gusts: tuple[SharpGust | CosineGust, ...] = ()
    doublets: tuple[Doublet, ...] = ()
    turbulence: Gustiness | None = None
    initial: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        """Check the duration, and that an adaptation is that of the controller."""
        if not 0.0 < self.duration < 1e7:
            raise ValueError(f"duration must be positive and below 1e7 [s], got {self.duration}")
        if self.adaptation is not None:
            if self.controller is None:
                raise ValueError("an adaptation scales a controller: give the scenario its controller too")
            self.adaptation.check(self.controller)


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """A scenario made ready: rows, grid, step. Runs of other seeds need nothing more.

    Attributes
    ----------
    stepper : Stepper
        Names and elements.
    scenario : Scenario
        What happens.
    stepping : Stepping
        As asked for.
    dt : float
        Base step. [s]
    steps : int
        Base steps to the end of the run.
    period, computing : int
        Base steps in a controller's sample and in its computing delay.
    knots : ndarray, shape (1, n_row, n_col)
        Rows of a flight that does not change; empty otherwise. [SI]
    per_knot : int
        Base steps between knots.
    exact : tuple of ndarray, shapes (n_x, n_x) and (4, n_x, n)
        Matrices of the exact step, empty for Runge-Kutta. [SI]
    substeps : int
        Runge-Kutta steps in a base step.
    halving : float, optional
        What the halving check found. [-]
    warnings : tuple of str
        What to know.
    """

    stepper: Stepper
    scenario: Scenario
    stepping: Stepping
    dt: float
    steps: int
    period: int
    computing: int
    knots: Array
    per_knot: int
    exact: tuple[Array, Array]
    substeps: int
    halving: float | None
    warnings: tuple[str, ...]


def start_state(s: Stepper, scenario: Scenario) -> Array:
    """Deviation from the equilibrium at the start.

    Parameters
    ----------
    s : Stepper
        Names of the states.
    scenario : Scenario
        Its `initial`.

    Returns
    -------
    x : ndarray, shape (n_x,)
        State. [SI]

    Raises
    ------
    ValueError
        If a name is no state or a value is not finite.
    """
    x = np.zeros(len(s.states))
    for name, value in scenario.initial:
        if name not in s.states:
            raise ValueError(f"initial {name!r} is no state; states: {', '.join(s.states)}")
        if not np.isfinite(value):
            raise ValueError(f"initial {name!r} must be finite, got {value}")
        x[s.states.index(name)] = value
    return x
