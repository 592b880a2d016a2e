"""The k method: flutter boundaries by a scan of reduced frequency instead of speed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.roots import frequency_scale, normalised, slowest
from aeroservo.aeroelastic.stability import Boundary, boundaries
from aeroservo.aeroelastic.tracking import follow, resolved_mesh
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.structure.modal import natural_modes

Array = NDArray[Any]


def harmonic_roots(model: AeroelasticModel, rho: float, k: Array, mach: float = 0.0) -> Array:
    """Complex frequencies w of -w^2 (M + rho b^2 Q(ik) / (2 k^2)) + i w D + K (1 + ig) = 0, as s = i w.

    At a fixed k the speed is w b / k, so aerodynamic forces grow as w^2 and join the mass. Where w
    is real the motion is harmonic at that very speed: a boundary of stability, exact with any D.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    rho : float
        Density. [kg/m^3]
    k : ndarray, shape (n_k,)
        Reduced frequency, positive. [-]
    mach : float
        Mach number at which Q is taken. [-]

    Returns
    -------
    s : complex ndarray, shape (n_k, n_roots)
        i w for the roots with Re w > 0; zero frequencies (rigid-body modes) left out, nan pads. [1/s]

    References
    ----------
    Theodorsen & Garrick, NACA Report 685, 1940; equations.md, "One equation of motion".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> harmonic_roots(AeroelasticModel(modes=one, aero=air), 1.2, np.array([0.5]))
    array([[0.+2.j]])
    """
    modes, b, n = model.modes, model.aero.b, model.modes.n
    kk = np.asarray(k, dtype=float)[:, None, None]
    mass = modes.M + 0.5 * rho * b**2 / kk**2 * model.aero(np.asarray(k, dtype=float), mach)[..., :n]
    stiffness = np.linalg.solve(mass, np.broadcast_to(modes.K * (1.0 + 1j * modes.hysteretic_g), mass.shape))
    if np.any(modes.D):
        A = np.zeros((len(kk), 2 * n, 2 * n), dtype=complex)
        A[:, np.arange(n), n + np.arange(n)] = 1.0
        A[:, n:, :n] = stiffness
        A[:, n:, n:] = np.linalg.solve(mass, np.broadcast_to(1j * modes.D, mass.shape))
        w = np.linalg.eigvals(A).astype(complex)
    else:
        w = np.sqrt(np.linalg.eigvals(stiffness).astype(complex))
    w = np.where((w.real > 0.0) & (np.abs(w) > 1e-9 * frequency_scale(model)), w, np.nan)
    w = np.take_along_axis(w, np.argsort(np.isnan(w.real), axis=1, kind="stable"), axis=1)[:, :n]
    return np.asarray(1j * w)


def k_boundaries(model: AeroelasticModel, condition: FlightCondition, *, points: int = 300) -> list[Boundary]:
    """Oscillatory boundaries of stability between the first and the last speed of a sweep.

    Parameters
    ----------
    model : AeroelasticModel
        With air forces at one Mach number.
    condition : FlightCondition
        Ascending speeds at one density, shape (n_V,).
    points : int
        Reduced frequencies in the scan.

    Returns
    -------
    boundaries : list of Boundary
        In order of speed. [m/s]

    Raises
    ------
    ValueError
        If the air forces depend on Mach number, which the k method holds fixed, or the stiffness on frequency.

    References
    ----------
    Theodorsen & Garrick, NACA Report 685, 1940.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> k_boundaries(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[1.0, 9.0], rho=1.2))
    []
    """
    if model.modes.relaxing:
        raise ValueError(
            "the k method needs a stiffness that does not depend on frequency: use p, pk or g for a viscoelastic "
            "structure"
        )
    if len(model.aero.mach) > 1:
        raise ValueError("the k method holds one Mach number, these air forces are given at several: use p-k")
    rho, b, scale = float(condition.rho[0]), model.aero.b, frequency_scale(model)
    reduced_speed = np.geomspace(condition.V[0] / (3.0 * scale * b), 1e5, points)

    def values_at(x: Array) -> Array:
        return harmonic_roots(model, rho, 1.0 / x)

    found = []
    for crossing in boundaries(values_at, reduced_speed, values_at(reduced_speed), scale):
        omega = crossing.root.imag
        V = omega * b * crossing.V
        if condition.V[0] <= V <= condition.V[-1] and _singular(model, condition[0], V, omega):
            opens = root_slope(model, condition[0], V, omega).real > 0.0
            found.append(Boundary(V=V, kind="oscillatory", opens=opens, root=1j * omega))
    return sorted(found, key=lambda boundary: boundary.V)


def _singular(model: AeroelasticModel, condition: FlightCondition, V: float, omega: float) -> bool:
    """Whether F(i omega) is singular at speed V: a zero, not a jump of w through a negative square."""
    air = 0.5 * float(condition.rho) * V**2 * model.aero(omega * model.aero.b / V)[:, : model.modes.n]
    sizes = np.linalg.svd(model.modes.dynamic_stiffness(1j * omega) - air, compute_uv=False)
    return bool(sizes[-1] < 1e-7 * sizes[0])


def k_curves(
    model: AeroelasticModel, condition: FlightCondition, *, points: int = 400
) -> tuple[tuple[str, ...], Array, Array, Array]:
    """V-g curves of the k method, each root followed over reduced frequency.

    Parameters
    ----------
    model : AeroelasticModel
        With air forces at one Mach number.
    condition : FlightCondition
        Ascending speeds at one density: the range to cover, shape (n_V,).
    points : int
        Reduced frequencies along each curve.

    Returns
    -------
    names : tuple of str
        Elastic modes, in order of frequency.
    speeds : ndarray, shape (n_points, n_modes)
        omega b / k, nan outside the range or where the root has no speed. [m/s]
    roots : complex ndarray, shape (n_points, n_modes)
        omega (g/2 + i) with (1 + i g) / omega^2 = 1 / w^2: g is the structural damping that would
        make the motion harmonic, positive where the wing is unstable without it. [1/s]
    shapes : complex ndarray, shape (n_points, n_modes, n)
        Shapes in the modes of the model. [-]

    References
    ----------
    Theodorsen & Garrick, NACA Report 685, 1940.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> k_curves(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[1.0, 9.0], rho=1.2))[0]
    ('h',)
    """
    natural = natural_modes(model.modes)
    names = tuple(name for name, omega in zip(natural.names, natural.omega) if omega > 0.0)
    rho, b, scale = float(condition.rho[0]), model.aero.b, frequency_scale(model)
    mesh = np.geomspace(
        0.3 * condition.V[0] / (scale * b), 10.0 * condition.V[-1] / (slowest(model) * b), max(points, len(names))
    )

    def values_at(x: Array) -> Array:
        return harmonic_roots(model, rho, 1.0 / x)

    mesh, values, steps = resolved_mesh(values_at, mesh, values_at(mesh), quarterings=3)
    s = np.take_along_axis(values, follow(values, steps), axis=1)
    elastic = np.argsort(np.where(np.isfinite(s[0]), -s[0].imag, np.inf))[: len(names)][::-1]
    s = s[:, elastic]
    inverse = -1.0 / s**2
    with np.errstate(invalid="ignore"):
        omega = 1.0 / np.sqrt(np.where(inverse.real > 0.0, inverse.real, np.nan))
        g = inverse.imag / inverse.real
        speeds = omega * b * mesh[:, None]
        speeds = np.where((speeds >= condition.V[0]) & (speeds <= condition.V[-1]), speeds, np.nan)
    shapes = _null_shapes(model, rho, np.broadcast_to(1.0 / mesh[:, None], s.shape), s)
    return names, speeds, np.where(np.isfinite(speeds), omega * (0.5 * g + 1j), np.nan), shapes


def _null_shapes(model: AeroelasticModel, rho: float, k: Array, s: Array) -> Array:
    """Shapes that solve the harmonic equation at its roots, largest entry 1."""
    modes, b = model.modes, model.aero.b
    w = np.where(np.isfinite(s), -1j * s, 1.0)[..., None, None]
    mass = modes.M + 0.5 * rho * b**2 / k[..., None, None] ** 2 * model.aero(k)[..., : modes.n]
    F = -(w**2) * mass + 1j * w * modes.D + modes.K * (1.0 + 1j * modes.hysteretic_g)
    return normalised(np.linalg.svd(F)[2][..., -1, :].conj())


def root_slope(model: AeroelasticModel, condition: FlightCondition, V: float, omega: float) -> complex:
    """Derivative ds/dV of a root that crosses the imaginary axis at speed V.

    From F(s, V) x = 0 and y^H F = 0: ds/dV = -(y^H dF/dV x) / (y^H dF/ds x), with Q' taken along
    the axis, so it is exact for any aerodynamics that are analytic there.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        One condition, for its density and speed of sound.
    V : float
        Speed of the crossing. [m/s]
    omega : float
        Frequency of the crossing. [rad/s]

    Returns
    -------
    slope : complex
        Change of s with speed, in (1/s) per (m/s); a positive real part is a loss of stability. [1/m]

    References
    ----------
    Lancaster, Numerische Mathematik 6, 1964, p. 377 (derivatives of eigenvalues of matrix functions).

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> abs(root_slope(AeroelasticModel(modes=one, aero=air), FlightCondition(V=1.0, rho=1.2), 3.0, 2.0))
    0.0
    """
    modes, aero, n = model.modes, model.aero, model.modes.n
    rho, b, s = float(condition.rho), aero.b, 1j * omega
    q, k, mach = 0.5 * rho * V * V, omega * b / V, V / float(condition.a_sound)
    Q, slope = aero(k, mach)[:, :n], aero.slope(k, mach)[:, :n]
    F = modes.dynamic_stiffness(s) - q * Q
    left, _, right = np.linalg.svd(F)
    y, x = left[:, -1].conj(), right[-1].conj()
    step = 1e-6 * mach
    compressibility = (aero(k, mach + step)[:, :n] - aero(k, mach - step)[:, :n]) / (
        2.0 * step * float(condition.a_sound)
    )
    dF_ds = 2.0 * s * modes.M + modes.D - q * b / V * slope + modes.relaxation_slope(s)
    dF_dV = -rho * V * Q + q * s * b / V**2 * slope - q * compressibility
    return complex(-(y @ dF_dV @ x) / (y @ dF_ds @ x))
