"""What the live models are made of: the first modes of a model in rational air forces, and its torsional stiffness."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from aeroservo.aero.rational import fit_rational
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.datatypes import AeroelasticModel, Array, SampledAero

MODES = 5
"""Modes kept of a model that has more: so few are enough for the first instability."""
FIT_BOUND = 0.01
"""Error of a fit of sampled air forces that is taken, part of the largest |Q| of each column."""


def small_model(model: AeroelasticModel) -> tuple[AeroelasticModel, float | None]:
    """The first modes of a model, in rational air forces.

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    model, error : AeroelasticModel, float or None
        For dynamics, and the error of the fit of sampled air forces, part of the largest |Q| of each column. [SI, -]

    Raises
    ------
    ValueError
        If the air forces cannot be fitted to a hundredth.
    """
    n = model.modes.n
    if n > MODES + 1:
        model = first_modes(model, MODES)
    if not isinstance(model.aero, SampledAero):
        return model, None
    modes = replace(model.modes, hysteretic_g=0.0)
    fit = fit_rational(model.aero)
    if fit.error > FIT_BOUND:
        raise ValueError(
            f"the air forces cannot be fitted by rational ones: error {fit.error:.2g}, bound {FIT_BOUND:g}"
        )
    return replace(model, modes=modes, aero=fit.aero), fit.error


def first_modes(model: AeroelasticModel, n: int) -> AeroelasticModel:
    """A model in its first coordinates only.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    n : int
        Coordinates kept.

    Returns
    -------
    model : AeroelasticModel
        For dynamics; without loads and statics. [SI]
    """
    m, aero = model.modes, model.aero
    modes = replace(
        m, M=m.M[:n, :n], D=m.D[:n, :n], K=m.K[:n, :n], names=m.names[:n], units=m.units[:n], phi=m.phi[..., :n],
        M_control=m.M_control[:n], relaxing=tuple(replace(branch, K=branch.K[:n, :n]) for branch in m.relaxing),
    )  # fmt: skip
    keep = [*range(n), *range(m.n, len(aero.inputs))]
    inputs = tuple(aero.inputs[k] for k in keep)
    if isinstance(aero, SampledAero):
        small: Any = replace(aero, Q=aero.Q[:, :, :n][..., keep], inputs=inputs)
    else:
        parts = {name: getattr(aero, name)[:, :n][..., keep] for name in ("A0", "A1", "A2")}
        small = replace(aero, **parts, lag_D=aero.lag_D[:, :n], lag_E=aero.lag_E[:, keep], inputs=inputs)
    springs = tuple(s for s in model.springs if s.mode in modes.names)
    limits = tuple(x for x in model.limits if x.mode in modes.names)
    sensors = tuple(
        replace(s, displacement=s.displacement[:n], rate=s.rate[:n], acceleration=s.acceleration[:n])
        for s in model.sensors
    )
    return replace(
        model,
        modes=modes,
        aero=small,
        loads=None,
        statics=None,
        rolling=None,
        springs=springs,
        limits=limits,
        sensors=sensors,
    )


def torsional_stiffness(file: FileModel, model: AeroelasticModel) -> Array:
    """The part of a model's stiffness that is torsion, in its modes.

    Parameters
    ----------
    file : FileModel
        The file.
    model : AeroelasticModel
        With all or the first modes of the file's.

    Returns
    -------
    K : ndarray, shape (n, n)
        Zero where it is not known: other kinds of model, beams whose bending and torsion are coupled or whose axis has
        corners. [SI]
    """
    K, n = np.array(model.modes.K), model.modes.n
    own = np.zeros((n, n))
    for name in ("pitch", "torsion 1"):
        if name in model.modes.names and not isinstance(file, BeamWing | AircraftFile):
            j = model.modes.names.index(name)
            if np.count_nonzero(K[j]) == 1 and np.count_nonzero(K[:, j]) == 1:
                own[j, j] = K[j, j]
                return own
    if isinstance(file, BeamWing | AircraftFile):
        return _beam_torsion(file, n)
    return own


def _beam_torsion(file: BeamWing | AircraftFile, n: int) -> Array:
    """Integral of GJ twist' twist' over the span, checked against the modes' own shares of strain energy."""
    from aeroservo.aeroelastic.aircraft_wing import aircraft_wing
    from aeroservo.aeroelastic.build_beam import BEAM_MODES, beam_wing
    from aeroservo.structure.beam import beam_modes

    beam = (aircraft_wing(file) if isinstance(file, AircraftFile) else beam_wing(file)).beam
    rigid = 0 if beam.root == "clamped" else 2 if beam.symmetry == "symmetric" else 1
    points = np.unique(np.concatenate([np.linspace(beam.y[0], beam.y[-1], 1601), beam.y]))
    found = beam_modes(beam, n=BEAM_MODES + rigid, points=points)
    middle, step = 0.5 * (points[1:] + points[:-1]), np.diff(points)
    rate = np.diff(found.twist[:, :n], axis=0) / step[:, None]
    K = np.einsum("s,si,sj->ij", beam.at("GJ", middle) * step, rate, rate)
    share = (found.torsion_share * found.omega**2)[:n]
    good = np.all(np.abs(np.diag(K) - share) <= 1e-4 * np.maximum(found.omega[:n] ** 2, 1e-300))
    return K if good else np.zeros((n, n))
