"""Span loading of an elastic wing in level flight against that of the rigid wing carrying the same weight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.static import divergence, elastic_stiffness
from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanLoad:
    """Loads per length of flexural axis, of the elastic and of the rigid wing at the same total lift.

    Attributes
    ----------
    V : ndarray, shape (n_V,)
        Speeds. [m/s]
    y, width : ndarray, shape (n_strips,)
        Distance of the strips from the plane of symmetry, and the length of axis that each stands for. [m]
    lift, rigid_lift : ndarray, shape (n_V, n_strips)
        Per length of axis, positive up; nan at and past divergence. [N/m]
    torque, rigid_torque : ndarray, shape (n_V, n_strips)
        About the flexural axis, positive nose up. [N]
    incidence, rigid_incidence : ndarray, shape (n_V,)
        Of the root. [rad]
    bending_moment, rigid_bending_moment : ndarray, shape (n_V,)
        Of the air forces at the root, about the x axis, positive tip up. [N m]
    """

    V: Array
    y: Array
    width: Array
    lift: Array
    rigid_lift: Array
    torque: Array
    rigid_torque: Array
    incidence: Array
    rigid_incidence: Array
    bending_moment: Array
    rigid_bending_moment: Array


def span_load(model: AeroelasticModel, sweep: FlightCondition, *, load_factor: float = 1.0) -> SpanLoad:
    """How elasticity moves the lift along the span, in trimmed flight at a load factor.

    The root is held at the incidence at which lift equals weight times load factor; elastic deflection is that under
    air forces and the wing's own weight times load factor (where the model knows it). Linear: small deflections,
    attached flow, sections that do not feel each other.

    Parameters
    ----------
    model : AeroelasticModel
        With strips (`loads.lift`), a mass, and the steady column "incidence".
    sweep : FlightCondition
        Speeds at one density, shape (n_V,). [m/s, kg/m^3]
    load_factor : float
        Lift over weight. [-]

    Returns
    -------
    load : SpanLoad
        Elastic and rigid. [N/m, N, rad, N m]

    Raises
    ------
    ValueError
        If the model has no strips, mass or incidence, or the sweep is not a row.

    References
    ----------
    Bramstång 2015, section 7.2 (Eqs. 7.9-7.13) in modal form; equations.md, "Static aeroelasticity".

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> found = span_load(build(read("goland")), FlightCondition(V=[50.0, 200.0], rho=1.225))
    >>> bool(found.bending_moment[1] > found.bending_moment[0] > found.rigid_bending_moment[0])  # load moves outboard
    True
    """
    mass = model.mass
    model = model.statics or model
    loads, column = model.loads, model.column("incidence")
    if loads is None or not loads.y.size or mass is None or column is None:
        raise ValueError("a span load needs a model with strips, a mass and the steady column 'incidence'")
    if sweep.V.ndim != 1:
        raise ValueError(f"the sweep must be a row of speeds [m/s], got shape {sweep.V.shape}")
    index, K = elastic_stiffness(model)
    q, wanted = sweep.q, load_factor * mass * STANDARD_GRAVITY
    Q0 = model.aero(np.zeros(q.shape), sweep.mach).real[:, index]
    camber = model.column("camber")
    limit = divergence(model, sweep[0]).q
    usable = q < (np.inf if limit is None else limit * (1.0 - 1e-12))
    steady = np.zeros((q.size, len(model.aero.inputs)))
    if camber is not None:
        steady[:, camber] = 1.0
    matrix = np.where(usable[:, None, None], K - q[:, None, None] * Q0[..., index], K)
    weight = loads.weight[index] if loads.weight.size else np.zeros(len(index))
    force = q[:, None] * (Q0 @ steady[:, :, None])[..., 0] + load_factor * weight
    right = np.stack([force, q[:, None] * Q0[..., column]], axis=-1)
    base, per_incidence = np.moveaxis(np.linalg.solve(matrix, right), -1, 0)
    fixed, unit = steady.copy(), np.zeros_like(steady)
    fixed[:, index] += base
    unit[:, index], unit[:, column] = per_incidence, 1.0
    row = loads.row("lift")
    incidence = (wanted - q * (fixed @ row)) / (q * (unit @ row))
    rigid_incidence = (wanted - q * (steady @ row)) / (q * row[column])
    elastic = np.where(usable[:, None], fixed + incidence[:, None] * unit, np.nan)
    rigid = steady.copy()
    rigid[:, column] += rigid_incidence
    roll = loads.row("roll")
    return SpanLoad(
        V=sweep.V,
        y=loads.y,
        width=loads.width,
        lift=q[:, None] * (elastic @ loads.lift.T),
        rigid_lift=q[:, None] * (rigid @ loads.lift.T),
        torque=q[:, None] * (elastic @ loads.torque.T),
        rigid_torque=q[:, None] * (rigid @ loads.torque.T),
        incidence=np.where(usable, incidence, np.nan),
        rigid_incidence=rigid_incidence,
        bending_moment=q * (elastic @ roll),
        rigid_bending_moment=q * (rigid @ roll),
    )
