"""The flexural axis of the surface that carries an aircraft's beam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aircraft.aircraft_schema import AircraftFile, Structure
from aeroservo.aircraft.geometry import LiftingSurface, span_stations
from aeroservo.datatypes import Array


def carrier(model: AircraftFile) -> LiftingSurface:
    """The surface that carries the beam.

    Parameters
    ----------
    model : AircraftFile
        With `[structure]`.

    Returns
    -------
    surface : LiftingSurface
        Of the file. [SI]

    Raises
    ------
    ValueError
        If the file has no structure.

    References
    ----------
    Project convention: model files, kind "aircraft".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> carrier(read("thesis-uav")).name
    'wing'
    """
    structure = structure_of(model)
    return next(s for s in model.surfaces() if s.name == structure.surface)


def structure_of(model: AircraftFile) -> Structure:
    """The structure of the file.

    Parameters
    ----------
    model : AircraftFile
        Any.

    Returns
    -------
    structure : Structure
        Its table. [SI]

    Raises
    ------
    ValueError
        If the file has none.

    References
    ----------
    Project convention: model files, kind "aircraft".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> structure_of(read("thesis-uav")).root
    'clamped'
    """
    if model.structure is None:
        raise ValueError(
            "structure: this aircraft has no [structure] table, so it is rigid: give EI, GJ, mass and inertia along "
            "the span of one surface ([[structure.station]]; `aeroservo new thesis-uav` writes a commented example)"
        )
    return model.structure


@dataclass(frozen=True, kw_only=True, eq=False)
class FlexuralAxis:
    """The flexural axis at all its corners (n), straight between; developed where there is dihedral."""

    y: Array  # (n,)  from the plane of symmetry  [m]
    r: Array  # (n,)  developed span from the root  [m]
    s: Array  # (n,)  along the axis from the root  [m]
    x: Array  # (n,)  aft  [m]
    chord: Array  # (n,)  streamwise  [m]
    flexural: Array  # (n,)  x/c  [-]
    sweep: Array  # (n - 1,)  of the panels  [rad]

    @staticmethod
    def of(model: AircraftFile) -> FlexuralAxis:
        """Corners at all stations of the structure and sections of the surface.

        Parameters
        ----------
        model : AircraftFile
            With `[structure]`.

        Returns
        -------
        axis : FlexuralAxis
            Straight between its corners. [m]

        Raises
        ------
        ValueError
            If the surface does not run outboard, or there is no structure.

        References
        ----------
        Project convention: model files, kind "aircraft".

        Examples
        --------
        >>> from aeroservo.aircraft.files import read
        >>> round(float(FlexuralAxis.of(read("thesis-uav")).s[-1]), 4)
        1.0599
        """
        surface, stations = carrier(model), structure_of(model).station
        sections = surface.leading_edge
        if np.any(np.diff(sections[:, 1]) <= 0.0):
            raise ValueError(
                f"structure.surface {surface.name!r}: a beam needs a surface that runs outboard, y_m ascending from "
                f"section to section [m], got {sections[:, 1].tolist()}"
            )
        given = np.array([station.y_m for station in stations])
        given[[0, -1]] = sections[[0, -1], 1]
        between = [y for y in sections[:, 1] if np.abs(given - y).min() > 1e-6]
        y = np.sort(np.concatenate([given, between]))
        chord = np.interp(y, sections[:, 1], surface.chords)
        flexural = np.interp(y, given, [station.flexural_axis for station in stations])
        x = np.interp(y, sections[:, 1], sections[:, 0]) + flexural * chord
        r = np.interp(y, sections[:, 1], span_stations(surface))
        s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(r)))])
        # rounded, so that panels in line have one sweep to the last bit, and one set of lag states
        sweep = np.round(np.arctan2(np.diff(x), np.diff(r)), 12)
        return FlexuralAxis(y=y, r=r, s=s, x=x, chord=chord, flexural=flexural, sweep=sweep)

    def panel(self, s: Array) -> Array:
        """Numbers of the panels at places along the axis. [-]"""
        return np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.sweep) - 1)

    def place(self, x: float | None, y: float) -> tuple[float, float]:
        """Place along the axis of the point (x, y), and how far aft of the axis it lies (x None: 0). [m]"""
        along, axis = float(np.interp(y, self.y, self.s)), float(np.interp(y, self.y, self.x))
        return along, 0.0 if x is None else x - axis
