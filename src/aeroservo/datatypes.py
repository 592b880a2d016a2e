"""The waist of the hourglass: the few types that every discipline shares.

Everything here is a frozen dataclass of locked arrays. Airspeed and density live in
`FlightCondition` and nowhere else; a model meets them only inside an analysis. What each type
may and may not know is written down in docs/architecture.md.

The one equation behind these types (equations.md, "One equation of motion"):

    M q'' + M_control u'' + D q' + K q = q_bar Q(p) [q, u, w_g/V, 1],   p = s b / V

Over budget because the waist is one file, so that a newcomer finds every shared type in it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.atmosphere import atmosphere
from aeroservo.servo import Actuator, Gravity, LiftCurve, Limit, Sensor

if TYPE_CHECKING:
    import control

Array = NDArray[Any]
InputKind = Literal["mode", "control", "gust", "steady"]


def frozen(x: ArrayLike, *, dtype: Any = float, ndim: int | None = None, name: str = "array") -> Array:
    """Copy `x` to a read-only array, checking rank and finiteness.

    Parameters
    ----------
    x : array_like, shape (...)
        Values, in any unit. [any]
    dtype : dtype
        Kind of number wanted.
    ndim : int, optional
        Number of axes required.
    name : str
        What to call the array in an error.

    Returns
    -------
    array : ndarray, shape of `x`
        A locked copy. [unit of `x`]

    Raises
    ------
    ValueError
        If the rank differs from `ndim` or a value is not finite.

    References
    ----------
    Project convention: docs/architecture.md, "Locked arrays".

    Examples
    --------
    >>> frozen([1, 2]).flags.writeable
    False
    """
    array = np.array(x, dtype=dtype)
    if ndim is not None and array.ndim != ndim:
        raise ValueError(f"{name} must have {ndim} axes, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} holds a value that is not finite")
    array.flags.writeable = False
    return array


@dataclass(frozen=True, kw_only=True, eq=False)
class FlightCondition:
    """Airspeed, density and speed of sound; they broadcast, so one object is a whole sweep.

    Attributes
    ----------
    V : ndarray, shape (...)
        True airspeed, positive. [m/s]
    rho : ndarray, shape (...)
        Air density, positive (0 is allowed: vacuum). [kg/m^3]
    a_sound : ndarray, shape (...)
        Speed of sound, default the sea-level value. [m/s]
    """

    V: Array
    rho: Array
    a_sound: Array = field(default_factory=lambda: np.asarray(340.294))

    def __post_init__(self) -> None:
        """Broadcast the three fields against each other, lock and check them."""
        for name, value in zip(("V", "rho", "a_sound"), np.broadcast_arrays(self.V, self.rho, self.a_sound)):
            object.__setattr__(self, name, frozen(value, name=name))
        if np.any(self.V <= 0.0):
            raise ValueError(f"airspeed V must be positive [m/s], got {self.V.min():g}")
        if np.any(self.rho < 0.0):
            raise ValueError(f"density rho must not be negative [kg/m^3], got {self.rho.min():g}")
        if np.any(self.a_sound <= 0.0):
            raise ValueError(f"speed of sound a_sound must be positive [m/s], got {self.a_sound.min():g}")

    @classmethod
    def at(
        cls, altitude: ArrayLike = 0.0, *, V: ArrayLike | None = None, mach: ArrayLike | None = None
    ) -> FlightCondition:
        """Condition in the standard atmosphere at a geopotential altitude.

        Parameters
        ----------
        altitude : array_like, shape (...)
            Geopotential altitude. [m]
        V : array_like, shape (...), optional
            True airspeed; give this or `mach`. [m/s]
        mach : array_like, shape (...), optional
            Mach number; give this or `V`. [-]

        Returns
        -------
        condition : FlightCondition
            Broadcast over all arguments.

        Raises
        ------
        ValueError
            If neither or both of `V` and `mach` are given, or the altitude is outside the atmosphere.

        References
        ----------
        U.S. Standard Atmosphere, 1976; Bramstång 2015, Eq. 3.7 and section 3.1.

        Examples
        --------
        >>> round(float(FlightCondition.at(3048.0, V=50.0).rho), 6)
        0.904637
        """
        if (V is None) == (mach is None):
            raise ValueError("give either V [m/s] or mach [-], not both and not neither")
        air = atmosphere(altitude)
        speed = np.asarray(V, dtype=float) if V is not None else np.asarray(mach, dtype=float) * air.a_sound
        return cls(V=speed, rho=air.rho, a_sound=air.a_sound)

    @property
    def q(self) -> Array:
        """Dynamic pressure. [Pa]"""
        return 0.5 * self.rho * self.V**2

    @property
    def mach(self) -> Array:
        """Mach number. [-]"""
        return self.V / self.a_sound

    @property
    def eas(self) -> Array:
        """Equivalent airspeed, referred to 1.225 kg/m^3. [m/s]"""
        return self.V * np.sqrt(self.rho / 1.225)

    def __getitem__(self, index: Any) -> FlightCondition:
        """One condition, or a part, of a sweep."""
        return FlightCondition(V=self.V[index], rho=self.rho[index], a_sound=self.a_sound[index])


@dataclass(frozen=True, kw_only=True, eq=False)
class Relaxation:
    """One branch of a viscoelastic stiffness: the part of K that is gone when a strain has been held for long.

    Attributes
    ----------
    time : float
        Relaxation time. [s]
    K : ndarray, shape (n, n)
        Stiffness that relaxes, symmetric, positive semidefinite: K (t) = K - sum of K_j (1 - exp(-t/time_j)). [SI]
    """

    time: float
    K: Array

    def __post_init__(self) -> None:
        """Lock the matrix and check it."""
        object.__setattr__(self, "K", frozen(self.K, ndim=2, name="K of a relaxation"))
        if not 0.0 < self.time < np.inf:
            raise ValueError(f"time of a relaxation must be positive [s], got {self.time}")
        size = np.abs(self.K).max(initial=0.0)
        if not np.allclose(self.K, self.K.T, rtol=1e-8, atol=1e-10 * size):
            raise ValueError("K of a relaxation must be symmetric")
        if np.linalg.eigvalsh(self.K).min(initial=0.0) < -1e-9 * size:
            raise ValueError("K of a relaxation must not be negative: stiffness relaxes, it does not grow")

    @cached_property
    def strain(self) -> Array:
        """Rows R with R^T R = K, one for each internal state: time y' = R q - y, force R^T y, shape (r, n). [SI]"""
        values, vectors = np.linalg.eigh(0.5 * (self.K + self.K.T))
        used = values > 1e-13 * values.max(initial=0.0)
        return np.asarray(np.sqrt(values[used])[:, None] * vectors[:, used].T)


@dataclass(frozen=True, kw_only=True, eq=False)
class ModalModel:
    """A structure in generalised coordinates; no air in it.

    Attributes
    ----------
    M, D, K : ndarray, shape (n, n)
        Mass, viscous damping and stiffness; the unit follows the coordinate. M is symmetric and
        positive definite; a rigid-body mode is one whose column of K is zero. [SI]
    names : tuple of str, length n
        Names of the coordinates (modes).
    M_control : ndarray, shape (n, n_u)
        Inertia coupling to the acceleration of the control surfaces. [SI]
    phi : ndarray, shape (n_grid, 6, n)
        Displacement (x, y, z) and rotation vector of each grid point per unit of each coordinate,
        in geometry axes (x aft, y starboard, z up). [m, rad per unit]
    grid : ndarray, shape (n_grid, 3)
        Grid points in geometry axes. [m]
    hysteretic_g : float
        Structural (hysteretic) damping: K becomes K (1 + i g) in frequency-domain methods only. [-]
    units : tuple of str, length n
        Unit of each coordinate ("m", "rad"; empty where it has none).
    relaxing : tuple of Relaxation
        Parts of K, which is the instantaneous (glassy) stiffness, that relax: a viscoelastic structure.
    """

    M: Array
    D: Array
    K: Array
    names: tuple[str, ...]
    M_control: Array = None  # type: ignore[assignment]
    phi: Array = None  # type: ignore[assignment]
    grid: Array = None  # type: ignore[assignment]
    hysteretic_g: float = 0.0
    units: tuple[str, ...] = ()
    relaxing: tuple[Relaxation, ...] = ()

    def __post_init__(self) -> None:
        """Lock the arrays and check the invariants."""
        n = len(self.names)
        for name in ("M", "D", "K"):
            matrix = frozen(getattr(self, name), ndim=2, name=name)
            if matrix.shape != (n, n):
                raise ValueError(f"{name} must have shape ({n}, {n}) for {n} modes, got {matrix.shape}")
            object.__setattr__(self, name, matrix)
        if not np.allclose(self.M, self.M.T, rtol=1e-8, atol=1e-10 * np.abs(self.M).max(initial=0.0)):
            raise ValueError("mass matrix M must be symmetric")
        scale = np.sqrt(np.abs(np.diag(self.M)))
        if np.any(np.diag(self.M) <= 0.0) or np.linalg.eigvalsh(self.M / np.outer(scale, scale)).min() <= 1e-12:
            raise ValueError("mass matrix M must be positive definite: check masses, inertias and the static moment")
        for name, shape in (("M_control", (n, 0)), ("phi", (0, 6, n)), ("grid", (0, 3))):
            value = getattr(self, name)
            array = frozen(np.zeros(shape) if value is None else value, ndim=len(shape), name=name)
            if any(want not in (0, got) for want, got in zip(shape, array.shape)):
                raise ValueError(f"{name} must have shape like {shape} (0: free), got {array.shape}")
            object.__setattr__(self, name, array)
        if self.phi.shape[0] != self.grid.shape[0]:
            raise ValueError("phi and grid must have the same number of points")
        object.__setattr__(self, "units", self.units or ("",) * n)
        if len(self.units) != n:
            raise ValueError(f"units must name one unit for each of {n} modes, got {self.units}")
        if not 0.0 <= self.hysteretic_g < 1.0:
            raise ValueError(f"hysteretic_g must lie in [0, 1), got {self.hysteretic_g:g}")
        self._check_relaxing()

    def _check_relaxing(self) -> None:
        """What relaxes must be of this structure and leave some of it."""
        if not self.relaxing:
            return
        if self.hysteretic_g:
            raise ValueError("a viscoelastic structure has its own damping: leave out hysteretic damping")
        if any(branch.K.shape != self.K.shape for branch in self.relaxing):
            raise ValueError(f"relaxing parts must have the shape of K, {self.K.shape}")
        left, size = self.relaxed_K, np.abs(self.K).max(initial=0.0)
        if np.linalg.eigvalsh(0.5 * (left + left.T)).min() < -1e-9 * size:
            raise ValueError("the relaxed stiffness is negative: ratios of what relaxes must add up to less than 1")

    @property
    def relaxed_K(self) -> Array:
        """Long-term stiffness, shape (n, n): K itself where nothing relaxes. [SI]"""
        return self.K - sum(branch.K for branch in self.relaxing) if self.relaxing else self.K

    def relaxation(self, s: ArrayLike) -> Array:
        """What relaxation adds to K at Laplace variables s (...): -sum K_j/(1 + s time_j), shape (..., n, n). [SI]"""
        s = np.asarray(s, dtype=complex)[..., None, None]
        out = np.zeros((*s.shape[:-2], self.n, self.n), dtype=complex)
        for branch in self.relaxing:
            out = out - branch.K / (1.0 + s * branch.time)
        return out

    def relaxation_slope(self, s: ArrayLike) -> Array:
        """Derivative of `relaxation` with respect to s, shape (..., n, n). [SI]"""
        s = np.asarray(s, dtype=complex)[..., None, None]
        out = np.zeros((*s.shape[:-2], self.n, self.n), dtype=complex)
        for branch in self.relaxing:
            out = out + branch.K * branch.time / (1.0 + s * branch.time) ** 2
        return out

    @property
    def n(self) -> int:
        """Number of generalised coordinates. [-]"""
        return len(self.names)

    def dynamic_stiffness(self, s: ArrayLike) -> Array:
        """Structural dynamic stiffness s^2 M + s D + K (1 + i g sign(Im s)) - sum K_j/(1 + s time_j).

        Parameters
        ----------
        s : array_like, shape (...)
            Laplace variable. [rad/s]

        Returns
        -------
        Z : complex ndarray, shape (..., n, n)
            Force per unit of each coordinate. [SI]

        References
        ----------
        equations.md, "One equation of motion" and "Moving axes, structural damping" [7.37]; Christensen, Theory of
        Viscoelasticity, 1982, section 1.6 (complex modulus of the generalised Maxwell body).

        Examples
        --------
        >>> one = ModalModel(M=[[2.0]], D=[[0.0]], K=[[8.0]], names=("h",))
        >>> abs(complex(one.dynamic_stiffness(2j)[0, 0]))
        0.0
        """
        z = np.asarray(s, dtype=complex)[..., None, None]
        Z = z * z * self.M + z * self.D + self.K * (1.0 + 1j * self.hysteretic_g * np.sign(z.imag))
        return Z + self.relaxation(s) if self.relaxing else Z


@dataclass(frozen=True, kw_only=True, eq=False)
class AeroInput:
    """One named column of Q.

    Attributes
    ----------
    name : str
        Name of the mode, control surface, gust zone or steady column.
    kind : {"mode", "control", "gust", "steady"}
        Modes come first and in the order of the structure. Controls are per radian. Gusts are per
        unit w_g / V, w_g positive up, their phase referred to the leading edge at `x_offset`.
        Steady columns are per unit (1 for camber and washout, 1 rad for a rigid incidence).
    x_offset : float
        Distance of a gust zone behind the reference point: it is met x_offset / V later. [m]
    """

    name: str
    kind: InputKind
    x_offset: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class SampledAero:
    """Generalised air forces q_bar Q(ik, Mach) at samples of reduced frequency: the exact form.

    Between samples Q is a cubic spline in k and linear in Mach; beyond the last k it goes on as
    Re Q ~ c0 + c2 k^2, Im Q ~ c1 k (apparent mass and damping), below the first likewise. Mach
    outside the samples takes the nearest.

    Attributes
    ----------
    k : ndarray, shape (n_k,)
        Reduced frequencies omega b / V, ascending, not negative. [-]
    Q : complex ndarray, shape (n_mach, n_k, n, n_in)
        Force = + q_bar Q at e^(+i omega t). [SI]
    b : float
        Reference semi-chord of k. [m]
    inputs : tuple of AeroInput, length n_in
        The columns; the first n are the modes.
    mach : ndarray, shape (n_mach,)
        Mach numbers, ascending. [-]
    """

    k: Array
    Q: Array
    b: float
    inputs: tuple[AeroInput, ...]
    mach: Array = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        """Lock the arrays and check the invariants."""
        object.__setattr__(self, "k", frozen(self.k, ndim=1, name="k"))
        object.__setattr__(self, "mach", frozen(self.mach, ndim=1, name="mach"))
        object.__setattr__(self, "Q", frozen(self.Q, dtype=complex, ndim=4, name="Q"))
        n_mach, n_k, n, n_in = self.Q.shape
        if (n_mach, n_k, n_in) != (len(self.mach), len(self.k), len(self.inputs)):
            raise ValueError(
                f"Q must have shape (n_mach, n_k, n, n_in) = ({len(self.mach)}, {len(self.k)}, n, "
                f"{len(self.inputs)}), got {self.Q.shape}"
            )
        if np.any(np.diff(self.k) <= 0.0) or self.k[0] < 0.0:
            raise ValueError("reduced frequencies k must ascend and not be negative")
        _check_common(self.mach, self.b, self.inputs, n)

    def __call__(self, k: ArrayLike, mach: ArrayLike = 0.0) -> Array:
        """Q at reduced frequency and Mach number.

        Parameters
        ----------
        k : array_like, shape (...)
            Reduced frequency, not negative. [-]
        mach : array_like, shape (...)
            Mach number. [-]

        Returns
        -------
        Q : complex ndarray, shape (..., n, n_in)
            Generalised force per unit dynamic pressure. [SI]

        References
        ----------
        equations.md, "One equation of motion for every model".

        Examples
        --------
        >>> one = SampledAero(k=[0.0], Q=[[[[1.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
        >>> complex(one(0.3)[0, 0])
        (1+0j)
        """
        return self._evaluate(k, mach, 0)

    def slope(self, k: ArrayLike, mach: ArrayLike = 0.0) -> Array:
        """Derivative dQ/d(ik) along the imaginary axis, shapes as `__call__`. [SI]"""
        return -1j * self._evaluate(k, mach, 1)

    def _evaluate(self, k: ArrayLike, mach: ArrayLike, order: int) -> Array:
        k, mach = np.broadcast_arrays(np.asarray(k, dtype=float), np.asarray(mach, dtype=float))
        n_in, n = len(self.inputs), self.Q.shape[2]
        if len(self.mach) == 1:
            return self._at_all_mach(k.ravel(), order)[0].reshape(*k.shape, n, n_in)
        values = self._at_all_mach(k.ravel(), order)
        left, weight = _mach_weights(self.mach, mach.ravel())
        rows = np.arange(k.size)
        blended = (
            values[left, rows] * (1.0 - weight)[:, None, None]
            + values[np.minimum(left + 1, len(self.mach) - 1), rows] * weight[:, None, None]
        )
        return blended.reshape(*k.shape, n, n_in)

    def _at_all_mach(self, k: Array, order: int) -> Array:
        """Spline and its tails: (n_mach, n_points, n, n_in)."""
        if self._spline is None:
            shape = (self.Q.shape[0], k.size, *self.Q.shape[2:])
            return np.broadcast_to(self.Q[:, :1], shape) if order == 0 else np.zeros(shape, complex)
        first, last = self.k[0], self.k[-1]
        inside = np.clip(k, first, last)
        Q = np.moveaxis(self._spline(inside, order), 0, 1)
        outside = k != inside
        if np.any(outside):
            Q = Q.copy()
            edge = inside[outside]
            value, rise = (np.moveaxis(self._spline(edge, i), 0, 1) for i in (0, 1))
            kk, edge = k[outside][:, None, None], edge[:, None, None]
            quadratic = rise.real / (2.0 * np.where(edge > 0.0, edge, 1.0))
            linear = value.imag / np.where(edge > 0.0, edge, 1.0)
            if order == 0:
                Q[:, outside] = value.real + quadratic * (kk**2 - edge**2) + 1j * linear * kk
            else:
                Q[:, outside] = 2.0 * quadratic * kk + 1j * linear
        return Q

    @cached_property
    def _spline(self) -> Any:
        """Cubic spline in k over axis 0: values (n_k, n_mach, n, n_in); None for a single sample."""
        if len(self.k) == 1:
            return None
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.k, np.moveaxis(self.Q, 1, 0), axis=0)


@dataclass(frozen=True, kw_only=True, eq=False)
class RationalAero:
    """Generalised air forces as a rational function of p = s b / V: the state-space form.

        Q(p) = A0 + A1 p + A2 p^2 + lag_D diag(p / (p + lags)) lag_E

    Roger's form is lag_E = stacked identities; Karpel's minimum state and strips with indicial
    functions have fewer rows.

    Attributes
    ----------
    A0, A1, A2 : ndarray, shape (n_mach, n, n_in)
        Stiffness, damping and apparent-mass terms; A2 of gust columns is 0. [SI]
    b : float
        Reference semi-chord of p. [m]
    inputs : tuple of AeroInput, length n_in
        The columns; the first n are the modes.
    lags : ndarray, shape (n_lag,)
        Reduced poles, positive, common over Mach. [-]
    lag_D : ndarray, shape (n_mach, n, n_lag)
        Force per lag state. [SI]
    lag_E : ndarray, shape (n_lag, n_in)
        Input of each lag state. [SI]
    mach : ndarray, shape (n_mach,)
        Mach numbers, ascending. [-]
    """

    A0: Array
    A1: Array
    A2: Array
    b: float
    inputs: tuple[AeroInput, ...]
    lags: Array = field(default_factory=lambda: np.zeros(0))
    lag_D: Array = None  # type: ignore[assignment]
    lag_E: Array = None  # type: ignore[assignment]
    mach: Array = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        """Lock the arrays and check the invariants."""
        object.__setattr__(self, "mach", frozen(self.mach, ndim=1, name="mach"))
        object.__setattr__(self, "lags", frozen(self.lags, ndim=1, name="lags"))
        n_mach, n_lag, n_in = len(self.mach), len(self.lags), len(self.inputs)
        n = sum(i.kind == "mode" for i in self.inputs)
        shapes = {
            "A0": (n_mach, n, n_in),
            "A1": (n_mach, n, n_in),
            "A2": (n_mach, n, n_in),
            "lag_D": (n_mach, n, n_lag),
            "lag_E": (n_lag, n_in),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            array = frozen(np.zeros(shape) if value is None else value, ndim=len(shape), name=name)
            if array.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
            object.__setattr__(self, name, array)
        if np.any(self.lags <= 0.0):
            raise ValueError(f"lags must be positive reduced poles, got {self.lags.min():g}")
        gusts = self.columns("gust")
        if np.any(self.A2[:, :, gusts]):
            raise ValueError("A2 of gust columns must be zero: a sharp edge would be an impulse")
        _check_common(self.mach, self.b, self.inputs, n)

    def columns(self, kind: InputKind) -> list[int]:
        """Indices of the inputs of one kind. [-]"""
        return [i for i, column in enumerate(self.inputs) if column.kind == kind]

    def matrices(self, mach: ArrayLike = 0.0) -> tuple[Array, Array, Array, Array]:
        """A0, A1, A2 (..., n, n_in) and lag_D (..., n, n_lag) at Mach numbers (...), linear between samples. [SI]"""
        mach = np.asarray(mach, dtype=float)
        stacks = (self.A0, self.A1, self.A2, self.lag_D)
        if len(self.mach) == 1:
            return tuple(x[0] for x in stacks)
        left, weight = _mach_weights(self.mach, mach)
        w = weight[..., None, None]
        right = np.minimum(left + 1, len(self.mach) - 1)
        return tuple(x[left] * (1.0 - w) + x[right] * w for x in stacks)

    def laplace(self, p: ArrayLike, mach: ArrayLike = 0.0) -> Array:
        """Q anywhere in the plane of the reduced Laplace variable p = s b / V.

        Parameters
        ----------
        p : array_like, shape (...)
            Reduced Laplace variable; poles at -lags. [-]
        mach : array_like, shape (...)
            Mach number. [-]

        Returns
        -------
        Q : complex ndarray, shape (..., n, n_in)
            Generalised force per unit dynamic pressure. [SI]

        References
        ----------
        Roger, AGARD CP-228, 1977; Karpel, J. Aircraft 19(3), 1982; equations.md, "One equation".

        Examples
        --------
        >>> one = RationalAero(A0=[[[1.0]]], A1=[[[2.0]]], A2=[[[0.0]]], b=1.0,
        ...                    inputs=(AeroInput(name="h", kind="mode"),))
        >>> complex(one.laplace(3.0)[0, 0])
        (7+0j)
        """
        p = np.asarray(p, dtype=complex)
        A0, A1, A2, lag_D = self.matrices(mach)
        pp = p[..., None, None]
        Q = A0 + A1 * pp + A2 * pp**2
        if len(self.lags):
            ratio = p[..., None] / (p[..., None] + self.lags)
            Q = Q + (lag_D * ratio[..., None, :]) @ self.lag_E
        return Q

    def __call__(self, k: ArrayLike, mach: ArrayLike = 0.0) -> Array:
        """Q(ik): shapes as `laplace`. [SI]"""
        return self.laplace(1j * np.asarray(k, dtype=float), mach)

    def slope(self, k: ArrayLike, mach: ArrayLike = 0.0) -> Array:
        """Derivative dQ/dp at p = ik, shapes as `laplace`. [SI]"""
        p = 1j * np.asarray(k, dtype=float)
        _, A1, A2, lag_D = self.matrices(mach)
        Q = A1 + 2.0 * A2 * p[..., None, None]
        if len(self.lags):
            ratio = self.lags / (p[..., None] + self.lags) ** 2
            Q = Q + (lag_D * ratio[..., None, :]) @ self.lag_E
        return Q


@dataclass(frozen=True, kw_only=True, eq=False)
class StaticLoads:
    """Integrated loads of a model per unit dynamic pressure, in the columns of its Q.

    Attributes
    ----------
    names : tuple of str
        "lift" (up, N) and "roll" (starboard wing up, N m about the root), as far as they exist.
    Q : ndarray, shape (n_loads, n_in)
        Load = q_bar Q [q, u, w_g/V, 1]. [m^2 or m^3 per unit]
    y, width : ndarray, shape (n_strips,)
        Span coordinate of each strip [m] and the length of flexural axis that it stands for [m]; empty where the
        model has no strips.
    lift, torque : ndarray, shape (n_strips, n_in)
        Lift up [m per unit] and torque about the flexural axis, nose up [m^2 per unit], per length of axis and q_bar.
    weight : ndarray, shape (n,)
        Generalised force of gravity on each mode, root level; empty where it is not known. [N per unit]
    limit : float
        Dynamic pressure up to which the modes resolve static deflections; beyond it no divergence or reversal is
        sought. [Pa]
    """

    names: tuple[str, ...]
    Q: Array
    y: Array = ()  # type: ignore[assignment]
    width: Array = ()  # type: ignore[assignment]
    lift: Array = None  # type: ignore[assignment]
    torque: Array = None  # type: ignore[assignment]
    weight: Array = ()  # type: ignore[assignment]
    limit: float = np.inf

    def __post_init__(self) -> None:
        """Lock the arrays and check their shapes."""
        object.__setattr__(self, "Q", frozen(self.Q, ndim=2, name="Q"))
        if self.Q.shape[0] != len(self.names):
            raise ValueError(f"Q must have one row for each of {self.names}, got shape {self.Q.shape}")
        for name in ("y", "weight"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=1, name=name))
        strips = (len(self.y), self.Q.shape[1])
        for name, shape in (("width", strips[:1]), ("lift", strips), ("torque", strips)):
            value = getattr(self, name)
            array = frozen(np.zeros(shape) if value is None else value, ndim=len(shape), name=name)
            if array.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
            object.__setattr__(self, name, array)
        if not self.limit > 0.0:
            raise ValueError(f"limit must be positive [Pa], got {self.limit:g}")

    def row(self, name: str) -> Array:
        """The row of one load, shape (n_in,). [m^2 or m^3 per unit]"""
        return self.Q[self.names.index(name)]


@dataclass(frozen=True, kw_only=True, eq=False)
class Spring:
    """A nonlinear spring on one coordinate: force = K (c0 + c1 x + c2 x^2 ...) x outside a dead band.

    Attributes
    ----------
    mode : str
        Name of the coordinate.
    polynomial : tuple of float
        Coefficients c0, c1, ... [-, 1/unit, ...]
    freeplay : float
        Half width of the dead band. [unit of the coordinate]
    stiffness : float, optional
        K of this spring alone; None takes it from the diagonal of the model's K, which holds K c0. [SI]
    """

    mode: str
    polynomial: tuple[float, ...] = (1.0,)
    freeplay: float = 0.0
    stiffness: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class AeroelasticModel:
    """Structure and air forces together: no airspeed, no density inside.

    Attributes
    ----------
    modes : ModalModel
        The structure.
    aero : SampledAero or RationalAero
        The air forces on the same modes, in the same order.
    name : str
        What to call it.
    loads : StaticLoads, optional
        Lift and rolling moment, for reversal, effectiveness and trim.
    springs : tuple of Spring
        Nonlinear springs; linear analyses take K as it is and say so.
    mass : float, optional
        Mass that the lift of `loads` carries (half an aircraft for a half wing). [kg]
    statics : AeroelasticModel, optional
        The same wing, root held, in as many modes as static deflections need: what static analyses use where it is
        given, so that dynamic ones can do with few modes.
    rolling : AeroelasticModel, optional
        As `statics`, in the air forces of antisymmetric motion where they are others: for reversal of roll.
    actuators : tuple of Actuator
        What moves the controls; a control without one follows its command at once.
    sensors : tuple of Sensor
        What is measured beside the coordinates and their rates.
    lift_curve : LiftCurve, optional
        Stall; linear analyses take the straight line.
    gravity : Gravity, optional
        Weight that the springs carry; linear analyses are about the equilibrium and leave it out.
    incidence : float
        Steady incidence (trim pitch) at which the column "incidence" acts. [rad]
    limits : tuple of Limit
        Where a simulation ends.
    """

    modes: ModalModel
    aero: SampledAero | RationalAero
    name: str = "model"
    loads: StaticLoads | None = None
    springs: tuple[Spring, ...] = ()
    mass: float | None = None
    statics: AeroelasticModel | None = None
    rolling: AeroelasticModel | None = None
    actuators: tuple[Actuator, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    lift_curve: LiftCurve | None = None
    gravity: Gravity | None = None
    incidence: float = 0.0
    limits: tuple[Limit, ...] = ()

    def __post_init__(self) -> None:
        """Check that structure, air forces and attachments speak of the same modes and controls."""
        columns = tuple(i.name for i in self.aero.inputs if i.kind == "mode")
        if columns != self.modes.names:
            raise ValueError(f"the modes of aero {columns} are not those of the structure {self.modes.names}")
        if self.loads is not None and self.loads.Q.shape[1] != len(self.aero.inputs):
            raise ValueError("loads must have one column for each input of aero")
        unknown = {spring.mode for spring in self.springs} - set(self.modes.names)
        if unknown:
            raise ValueError(f"springs name unknown modes {sorted(unknown)}; the modes are {self.modes.names}")
        moved, controls = [a.control for a in self.actuators], {i.name for i in self.aero.inputs if i.kind == "control"}
        if set(moved) - controls or len(set(moved)) != len(moved):
            raise ValueError(f"actuators must move different controls out of {sorted(controls)}, got {moved}")
        unknown = {limit.mode for limit in self.limits} - set(self.modes.names)
        if unknown:
            raise ValueError(f"limits name unknown modes {sorted(unknown)}; the modes are {self.modes.names}")

    def columns(self, kind: InputKind) -> list[int]:
        """Indices of the inputs of one kind. [-]"""
        return [i for i, column in enumerate(self.aero.inputs) if column.kind == kind]

    def column(self, name: str) -> int | None:
        """Index of a named input, None where there is none. [-]"""
        return next((i for i, column in enumerate(self.aero.inputs) if column.name == name), None)

    def with_K(self, K: Array) -> AeroelasticModel:
        """The same model on another stiffness matrix, shape (n, n), which its statics then use too. [SI]

        What relaxes of a viscoelastic structure stays as it is.
        """
        return replace(self, modes=replace(self.modes, K=K), statics=None, rolling=None)


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearSystem:
    """x' = A x + B u(t - delay), y = C x + D u; plants and controllers alike.

    Attributes
    ----------
    A, B, C, D : ndarray, shapes (..., n_x, n_x), (..., n_x, n_u), (..., n_y, n_x), (..., n_y, n_u)
        System matrices; leading axes are a batch. [SI]
    states, inputs, outputs : tuple of str
        Channel names, the unit as suffix (`pitch_rad`).
    dt : float, optional
        Sample time of a discrete system; None is continuous. [s]
    input_delay_s : float
        Delay of every input. [s]
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dt: float | None = None
    input_delay_s: float = 0.0

    def __post_init__(self) -> None:
        """Lock the arrays and check shapes, sample time and delay."""
        n_x, n_u, n_y = len(self.states), len(self.inputs), len(self.outputs)
        shapes = {"A": (n_x, n_x), "B": (n_x, n_u), "C": (n_y, n_x), "D": (n_y, n_u)}
        for name, shape in shapes.items():
            array = frozen(getattr(self, name), name=name)
            if array.shape[-2:] != shape:
                raise ValueError(f"{name} must end in shape {shape}, got {array.shape}")
            object.__setattr__(self, name, array)
        batches = {getattr(self, name).shape[:-2] for name in shapes}
        if len(batches) != 1:
            raise ValueError(f"A, B, C, D must share their leading axes, got {sorted(batches)}")
        if self.dt is not None and not self.dt > 0.0:
            raise ValueError(f"dt must be positive [s] or None, got {self.dt}")
        if not self.input_delay_s >= 0.0:
            raise ValueError(f"input_delay_s must not be negative [s], got {self.input_delay_s}")

    def __getitem__(self, index: Any) -> LinearSystem:
        """One system, or a part, of a batch."""
        return replace(self, **{name: getattr(self, name)[index] for name in "ABCD"})

    def to_control(self) -> control.StateSpace:
        """This system as python-control's StateSpace (one system only; the delay is not carried).

        Returns
        -------
        system : control.StateSpace
            With the same channel names. [SI]

        Raises
        ------
        ValueError
            If this is a batch, or has an input delay (python-control has no exact delay).

        References
        ----------
        python-control user guide, `control.ss`.

        Examples
        --------
        >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
        >>> lag = LinearSystem(A=[[-1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
        >>> lag.to_control().nstates
        1
        """
        import control

        if self.A.ndim != 2:
            raise ValueError(f"python-control holds one system: index this batch of shape {self.A.shape[:-2]} first")
        if self.input_delay_s:
            raise ValueError(f"python-control has no exact delay: input_delay_s is {self.input_delay_s} [s]")
        names = {"states": list(self.states), "inputs": list(self.inputs), "outputs": list(self.outputs)}
        return control.ss(self.A, self.B, self.C, self.D, 0 if self.dt is None else self.dt, **names)


def _check_common(mach: Array, b: float, inputs: tuple[AeroInput, ...], n: int) -> None:
    """Invariants that both forms of Q share."""
    if len(mach) == 0 or np.any(np.diff(mach) <= 0.0) or mach[0] < 0.0:
        raise ValueError("Mach numbers must ascend and not be negative")
    if not (np.isfinite(b) and b > 0.0):
        raise ValueError(f"reference semi-chord b must be positive [m], got {b}")
    names = [i.name for i in inputs]
    if len(set(names)) != len(names):
        raise ValueError(f"input names must differ, got {names}")
    if n == 0 or any((i.kind == "mode") != (j < n) for j, i in enumerate(inputs)):
        raise ValueError(f"the first {n} inputs, and no others, must be the modes")


def _mach_weights(mach: Array, wanted: Array) -> tuple[Array, Array]:
    """Index of the sample to the left and the weight of the one to the right; ends are held."""
    held = np.clip(wanted, mach[0], mach[-1])
    left = np.clip(np.searchsorted(mach, held, side="right") - 1, 0, len(mach) - 2)
    return left, (held - mach[left]) / (mach[left + 1] - mach[left])
