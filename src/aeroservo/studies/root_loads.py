"""Loads that a wing hands on to its root, and forces in the springs of a section.

Root loads are summed over the wing: air forces of every strip, with their lags, less mass times acceleration. Nothing
hangs on how well the modes resolve curvature at the root; the same sum by strains (EI times the curvature of the modes)
converges to it as modes are added.

Of a binary wing or the thesis' whole aircraft there are none: one assumed shape has one curvature, whatever the load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from aeroservo.aero.rational import fit_rational
from aeroservo.aero.strip import Theory, strip_aero, strip_shapes
from aeroservo.aeroelastic.build import DEFAULTS, THEORIES, build
from aeroservo.aeroelastic.build_beam import StripWing, beam_wing
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.aircraft.schema_other import PitchPlungeFlap
from aeroservo.aircraft.schema_section import TypicalSection
from aeroservo.datatypes import AeroelasticModel, Array, ModalModel, RationalAero, SampledAero, frozen

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel

#: Loads of the half wing on its root, in the order of the rows.
ROOT = ("root_shear_N", "root_bending_N_m", "root_torque_N_m")


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadRows:
    """Internal loads: springs q + air forces + inertia q''.

    Attributes
    ----------
    names : tuple of str
        With the unit as suffix.
    springs : ndarray, shape (n_loads, n)
        Per unit of the coordinates. [unit of the load per unit of the coordinate]
    inertia : ndarray, shape (n_loads, n)
        Per unit of their accelerations. [SI]
    air : AirRows, optional
        Air forces with the inputs and lags of the model's own.
    fit_error : float
        Error of the rational fit of the model's air forces, part of the largest |Q| of a column; 0 without fit. [-]
    """

    names: tuple[str, ...]
    springs: Array
    inertia: Array
    air: AirRows | None = None
    fit_error: float = 0.0

    def __post_init__(self) -> None:
        """Lock the rows and check their number."""
        for name in ("springs", "inertia"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=2, name=name))
            if len(getattr(self, name)) != len(self.names):
                raise ValueError(f"{name} must have {len(self.names)} rows, got {len(getattr(self, name))}")


@dataclass(frozen=True, kw_only=True, eq=False)
class AirRows:
    """Air forces of loads: q_bar (A0 + A1 p + A2 p^2) u + q_bar lag_D y, with the lags y of the model.

    Attributes
    ----------
    A0, A1, A2 : ndarray, shape (n_loads, n_in)
        [SI]
    lag_D : ndarray, shape (n_loads, n_lag)
        [SI]
    """

    A0: Array
    A1: Array
    A2: Array
    lag_D: Array


def with_loads(file: FileModel, aero: str | None = None) -> tuple[AeroelasticModel, LoadRows | None]:
    """The model of a file with rational air forces, and the internal loads that follow from its motion.

    Parameters
    ----------
    file : FileModel
        Any kind that `build` knows.
    aero : str, optional
        Air forces, by name; by kind of model if not given.

    Returns
    -------
    model : AeroelasticModel
        Samples fitted. [SI]
    loads : LoadRows or None
        Root shear (up), bending moment (tip up) about the x axis and torque (nose up) about the y axis through the
        flexural axis at the root, of a half wing on beams; forces of the springs of a section or a pitch-plunge model;
        None for other kinds, and for a section whose springs relax: their force is not K q.

    Raises
    ------
    ValueError
        As `build`.
    """
    model = build(file, aero)
    if isinstance(file, TypicalSection) and model.modes.relaxing:
        return _fitted(model, None)
    if isinstance(file, TypicalSection):
        names = ("plunge_spring_N_per_m", "pitch_spring_N")
        return _fitted(model, LoadRows(names=names, springs=model.modes.K[:2], inertia=0.0 * model.modes.K[:2]))
    if isinstance(file, PitchPlungeFlap):
        names = ("plunge_spring_N", "pitch_spring_N_m")
        return _fitted(model, LoadRows(names=names, springs=model.modes.K[:2], inertia=0.0 * model.modes.K[:2]))
    if isinstance(file, BeamWing | AircraftFile):
        from aeroservo.aeroelastic.aircraft_wing import aircraft_wing

        wing = beam_wing(file) if isinstance(file, BeamWing) else aircraft_wing(file)
        return root_loads(wing, model, THEORIES[aero or DEFAULTS[file.kind].aero or ""]())
    return _fitted(model, None)


def _fitted(model: AeroelasticModel, loads: LoadRows | None) -> tuple[AeroelasticModel, LoadRows | None]:
    """The same with rational air forces."""
    if not isinstance(model.aero, SampledAero):
        return model, loads
    fit = fit_rational(model.aero)
    rows = LoadRows(names=(), springs=np.zeros((0, model.modes.n)), inertia=np.zeros((0, model.modes.n)))
    return replace(model, aero=fit.aero), replace(loads or rows, fit_error=fit.error)


def root_loads(wing: StripWing, model: AeroelasticModel, theory: Theory) -> tuple[AeroelasticModel, LoadRows]:
    """A beam wing with the loads on its root, summed over strips and masses.

    Parameters
    ----------
    wing : StripWing
        Structure and strips.
    model : AeroelasticModel
        Of `beam_model` on the same wing and theory.
    theory : QuasiSteady, Indicial or Theodorsen
        Section theory.

    Returns
    -------
    model : AeroelasticModel
        The same motion; its lags are those that the loads share.
    loads : LoadRows
        `ROOT`; masses at the very root are inboard of the cut.
    """
    assert model.loads is not None
    beam, n = wing.beam, model.modes.n
    corners = beam.position(beam.y)
    s = np.interp(model.modes.grid[: len(model.loads.width), 1], corners[:, 1], beam.y)
    strips = wing.strips(s, model.loads.width)
    both = _with_rigid_motion(model.modes, corners[0])
    aero, _ = strip_aero(strips, strip_shapes(both, strips.sweep), both.names, theory)
    error = 0.0
    if isinstance(aero, SampledAero):
        fit = fit_rational(aero)
        aero, error = fit.aero, fit.error
    columns = [*range(n), *range(n + 3, len(aero.inputs))]
    E = aero.lag_E[:, columns]
    used = np.any(E, axis=1)
    own = RationalAero(
        A0=aero.A0[:, :n][..., columns],
        A1=aero.A1[:, :n][..., columns],
        A2=aero.A2[:, :n][..., columns],
        b=aero.b,
        inputs=tuple(aero.inputs[j] for j in columns),
        lags=aero.lags[used],
        lag_D=aero.lag_D[:, :n, used],
        lag_E=E[used],
        mach=aero.mach,
    )
    air = AirRows(
        A0=aero.A0[0, n:][:, columns],
        A1=aero.A1[0, n:][:, columns],
        A2=aero.A2[0, n:][:, columns],
        lag_D=aero.lag_D[0, n:, used].T,
    )
    inertia = -_coupling_mass(wing, both, s, model.loads.width)[n:, :n]
    return replace(model, aero=own), LoadRows(
        names=ROOT, springs=np.zeros((3, n)), inertia=inertia, air=air, fit_error=error
    )


def _with_rigid_motion(modes: ModalModel, root: Array) -> ModalModel:
    """The same modes, then the wing lifted by 1 m, turned tip up about x and nose up about y at the root."""
    arm = modes.grid - root
    rigid = np.zeros((len(arm), 6, 3))
    rigid[:, 2, 0] = 1.0
    rigid[:, 2, 1], rigid[:, 3, 1] = arm[:, 1], 1.0
    rigid[:, 2, 2], rigid[:, 4, 2] = -arm[:, 0], 1.0
    n = modes.n + 3
    return ModalModel(
        M=np.eye(n),
        D=np.zeros((n, n)),
        K=np.zeros((n, n)),
        names=(*modes.names, "root heave", "root roll", "root pitch"),
        phi=np.concatenate([modes.phi, rigid], axis=2),
        grid=modes.grid,
    )


def _coupling_mass(wing: StripWing, both: ModalModel, s: Array, width: Array) -> Array:
    """Mass between all motions: strips of mass, and lumps beyond the root, which are the last points of the grid."""
    beam, n = wing.beam, len(s)
    where = np.concatenate([s, beam.y[-1:], [lump.y for lump in beam.masses]])
    shapes = strip_shapes(both, beam.at("sweep", where))
    m, d, inertia = (np.zeros(len(where)) for _ in range(3))
    m[:n] = beam.at("mass", s) * width
    d[:n] = beam.at("cg_offset", s)
    inertia[:n] = beam.at("inertia", s) * width
    roll = np.zeros(len(where))
    for j, lump in enumerate(beam.masses):
        if lump.y > beam.y[0]:
            at = n + 1 + j
            m[at], d[at], roll[at] = lump.mass, lump.x, lump.roll_inertia
            inertia[at] = lump.inertia + lump.mass * lump.x**2
    h, twist, turn = shapes.h, shapes.twist, both.phi[: len(where), 3]
    static = (m * d)[:, None]
    return np.asarray(
        h.T @ (m[:, None] * h + static * twist) + twist.T @ (static * h + inertia[:, None] * twist)
        + turn.T @ (roll[:, None] * turn)
    )  # fmt: skip
