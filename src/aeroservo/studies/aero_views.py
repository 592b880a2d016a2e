"""One aircraft at one speed seen several ways: wing polars, hinged beside morphed, trim (thesis figures 4, 22-25)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from aeroservo.aero.polars import Polar
from aeroservo.aero.viscous_wing import Trim, WingPolar
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.studies.aircraft_aero import PANELS, surface_polars, with_control_kind
from aeroservo.studies.section_polar import Source
from aeroservo.studies.wing_polar import trimmed_wing, wing_polar

#: Static margins at which trim is looked for, of the reference chord. [-]
MARGINS = np.linspace(-0.10, 0.20, 31)
#: Deflections that trim may need, where polars have to be computed first. [rad]
_TRIM_REACH = np.radians([-10.0, 10.0])


@dataclass(frozen=True, kw_only=True, eq=False)
class WingCase:
    """An aircraft, its angles and its air.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    alpha, delta : ndarray, shapes (n_a,), (n_d,)
        Angles of attack, and deflections of all symmetric controls together. [rad]
    speed : float, optional
        Airspeed, for the Reynolds numbers; None where no section polars are wanted. [m/s]
    viscosity : float
        Kinematic viscosity. [m^2/s]
    method : VortexLattice
        Panels and Mach number.
    source : {"auto", "table", "neuralfoil", "xfoil"}
        What section polars are taken from.
    progress : callable, optional
        Called with each run of XFOIL before it starts.
    """

    model: AircraftFile
    alpha: np.ndarray
    delta: np.ndarray
    speed: float | None
    viscosity: float
    method: VortexLattice = PANELS
    source: Source = "auto"
    progress: Callable[[str], None] | None = None

    @cached_property
    def sections(self) -> tuple[Polar, ...]:
        """Section polars of the surfaces.

        Returns
        -------
        polars : tuple of Polar
            One for each surface. [-]

        Raises
        ------
        ValueError
            If there is no airspeed, or no section polar for a surface.
        """
        return surface_polars(
            self.model, speed=self._speed(), viscosity=self.viscosity, delta=self.delta, source=self.source,
            progress=self.progress,
        )  # fmt: skip

    def polars(self) -> tuple[WingPolar, ...]:
        """The wing's polars.

        Returns
        -------
        polars : tuple of WingPolar
            One for each deflection. [-]

        Raises
        ------
        ValueError
            If there is no airspeed, or no section polar for a surface.
        """
        return wing_polar(
            self.model, alpha=self.alpha, delta=self.delta, speed=self._speed(), viscosity=self.viscosity,
            method=self.method, polars=self.sections,
        )  # fmt: skip

    def both_kinds(self) -> list[tuple[str, np.ndarray, tuple[WingPolar, ...]]]:
        """Name, deflections [rad] and polars with every control hinged, then morphed."""
        return [
            (kind, self.delta, replace(self, model=with_control_kind(self.model, kind)).polars())
            for kind in ("hinged", "morphed")
        ]

    def trims(self, CL: float) -> list[tuple[str, Trim]]:
        """Trimmed states over `MARGINS`, with every control hinged, then morphed.

        Parameters
        ----------
        CL : float
            Lift coefficient to be carried. [-]

        Returns
        -------
        trims : list of (str, Trim)
            NaN where no balance lies inside the section polars.

        Raises
        ------
        ValueError
            If there is no airspeed, or no section polar for a surface.
        """
        out = []
        for kind in ("hinged", "morphed"):
            case = replace(self, model=with_control_kind(self.model, kind), delta=_TRIM_REACH)
            d = aircraft_lattice(case.model.surfaces(), case.model.references(), method=self.method).derivatives
            x_cg = d.neutral_point - MARGINS * d.reference.c
            trim = trimmed_wing(
                case.model, x_cg=x_cg, CL=CL, speed=self._speed(), viscosity=self.viscosity, method=self.method,
                polars=case.sections,
            )  # fmt: skip
            out.append((kind, trim))
        return out

    def said(self) -> str:
        """Where the section polars come from."""
        return "; ".join(dict.fromkeys(f"{p.name}: {p.source}" for p in self.sections))

    def _speed(self) -> float:
        if self.speed is None:
            raise ValueError("section polars need the airspeed [m/s], got none")
        return self.speed
