"""Shaping filters of all six components, for one condition or along a flight.

`shaping_filter` assembles the cores of `dryden.py` or `vonkarman.py` into one `LinearSystem` whose inputs are
independent unit white noises (autocorrelation delta(t)) and whose outputs are the gust velocities and rates. Leading
axes are a batch: one filter per airspeed of a sweep, or one per time step of a climb. `discretise` in `sampling.py`
turns it into an exact recursion at the plant's own step.

Components are those of the specification's body axes (u forward, v right, w down): the project's upward gust is -w.
Frozen field: valid for airspeeds well above the RMS of the turbulence.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import LinearSystem
from aeroservo.gust.dryden import Component, dryden_core, dryden_psd, rate_length, time_scale
from aeroservo.gust.intensity import Turbulence
from aeroservo.gust.vonkarman import blockset_core, von_karman_core, von_karman_psd

__all__ = ["Model", "RateSigns", "component_psd", "cs25_turbulence", "shaping_filter", "vertical_filter"]

Array = NDArray[Any]
Model = Literal["dryden", "von_karman", "von_karman_blockset"]
RateSigns = Literal["+q-r", "+q+r", "-q+r"]

_CORES = {"dryden": dryden_core, "von_karman": von_karman_core, "von_karman_blockset": blockset_core}
_VELOCITIES: tuple[Component, ...] = ("u", "v", "w")
_RATES: tuple[Component, ...] = ("p", "q", "r")


def component_psd(
    omega: ArrayLike,
    state: Turbulence,
    V: ArrayLike,
    *,
    component: Component,
    span: float | None = None,
    model: Model = "dryden",
) -> Array:
    """One-sided power spectral density of one component of a turbulence state.

    Parameters
    ----------
    omega : array_like, shape (...)
        Angular frequency. [rad/s]
    state : Turbulence
        Intensities and lengths, leading axes broadcast with omega and V.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    component : {"u", "v", "w", "p", "q", "r"}
        Velocity or angular rate.
    span : float, optional
        Wingspan b, needed for the rates. [m]
    model : {"dryden", "von_karman", "von_karman_blockset"}
        Both von Karman names give the exact spectrum.

    Returns
    -------
    Phi : ndarray, shape (...)
        [(m/s)^2 s/rad], or [(rad/s)^2 s/rad] for the rates.

    Raises
    ------
    ValueError
        If a name is unknown or an argument outside its range.

    References
    ----------
    MIL-F-8785C, section 3.7; MIL-HDBK-1797, Appendix A (see `dryden_psd`, `von_karman_psd`).

    Examples
    --------
    >>> from aeroservo.gust.intensity import constant_turbulence
    >>> round(float(component_psd(0.0, constant_turbulence(1.0), 50.0, component="w")), 4)
    3.3957
    """
    _check_model(model)
    psd = dryden_psd if model == "dryden" else von_karman_psd
    i = {"u": 0, "v": 1, "w": 2, "p": 2, "q": 2, "r": 1}.get(component, 0)
    return psd(
        omega,
        component=component,
        V=V,
        length=state.length[..., i],
        intensity=state.intensity[..., i],
        span=span,
        specification=state.specification,
    )


def cs25_turbulence() -> Turbulence:
    """Unit turbulence of CS/FAR-25.341(b)(2): L = 762 m (2,500 ft), 1 m/s in every component.

    With `model="von_karman"` the RMS response to its w (or v) is the factor A of the clause; the limit load is
    P_1g +/- U_sigma A (`design_turbulence_load`, `cs25_turbulence_intensity`).

    Returns
    -------
    state : Turbulence
        In the convention of MIL-F-8785C, whose von Karman spectra are the clause's.

    References
    ----------
    CS-25.341(b)(2), 14 CFR 25.341(b)(2).

    Examples
    --------
    >>> cs25_turbulence().length
    array([762., 762., 762.])
    """
    return Turbulence(intensity=np.ones(3), length=np.full(3, 762.0))


def shaping_filter(
    state: Turbulence,
    V: ArrayLike,
    *,
    span: float | None = None,
    model: Model = "dryden",
    rates: RateSigns = "+q-r",
) -> LinearSystem:
    """Filter from unit white noises to the gust velocities and, with a span, the gust rates.

    Parameters
    ----------
    state : Turbulence
        Intensities and lengths; leading axes broadcast with V.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    span : float, optional
        Wingspan b; without it there are no rates. [m]
    model : {"dryden", "von_karman", "von_karman_blockset"}
        Exact Dryden, the project's von Karman fit, or the Blockset's (for comparison).
    rates : {"+q-r", "+q+r", "-q+r"}
        Signs of q and r against w and v: the three forms the specification allows.

    Returns
    -------
    system : LinearSystem
        Inputs noise_u, noise_v, noise_w (and noise_p), unit white: variance 1/dt when held over dt. Outputs u_g, v_g,
        w_g [m/s] and p_g, q_g, r_g [rad/s]. q comes from the noise of w and r from that of v.

    Raises
    ------
    ValueError
        If a name is unknown or an argument outside its range.

    References
    ----------
    gusts.md section 1: H_q = (s/V)/(1 + 4 b s/(pi V)) H_w, H_r = (s/V)/(1 + 3 b s/(pi V)) H_v, from the spectra of
    MIL-F-8785C, section 3.7; the rates from memory of the standard.

    Examples
    --------
    >>> from aeroservo.gust.intensity import constant_turbulence
    >>> shaping_filter(constant_turbulence(1.0), 50.0, span=2.0).outputs
    ('u_g_m_s', 'v_g_m_s', 'w_g_m_s', 'p_g_rad_s', 'q_g_rad_s', 'r_g_rad_s')
    """
    _check_model(model)
    if rates not in get_args(RateSigns):
        raise ValueError(f"unknown rate signs {rates!r}: use one of {', '.join(get_args(RateSigns))}")
    V = np.asarray(V, dtype=float)
    batch = np.broadcast_shapes(V.shape, state.intensity.shape[:-1])
    V = np.broadcast_to(V, batch)
    blocks = []
    for i, component in enumerate(_VELOCITIES):
        T = time_scale(component, V, state.length[..., i], state.specification)
        core = _scaled(_CORES[model](component), T, np.broadcast_to(state.intensity[..., i], batch))
        if span is not None and component != "u":
            rate: Component = "r" if component == "v" else "q"
            sign = 1.0 if f"+{rate}" in rates else -1.0
            core = _with_rate(core, rate_length(rate, span), V, sign)
        blocks.append(core)
    if span is not None:
        blocks.append(_roll_rate(state, V, span))
    return _assemble(blocks, batch, span is not None)


def vertical_filter(state: Turbulence, V: ArrayLike, *, model: Model = "dryden") -> LinearSystem:
    """Filter of the vertical gust alone, positive UP: what a symmetric gust column of air forces takes.

    Parameters
    ----------
    state : Turbulence
        Intensities and lengths; leading axes broadcast with V.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    model : {"dryden", "von_karman", "von_karman_blockset"}
        As in `shaping_filter`.

    Returns
    -------
    system : LinearSystem
        Input noise_w, unit white; output gust_m_s. [m/s]

    Raises
    ------
    ValueError
        If a name is unknown or an argument outside its range.

    References
    ----------
    As `shaping_filter`; equations.md, "Conventions": gust w_g positive UP (the specification's w is down).

    Examples
    --------
    >>> from aeroservo.gust.intensity import constant_turbulence
    >>> vertical_filter(constant_turbulence(1.0), 50.0).states
    ('x_w1', 'x_w2')
    """
    full = shaping_filter(state, V, model=model)
    own = [i for i, name in enumerate(full.states) if name.startswith("x_w")]
    noise, row = [full.inputs.index("noise_w")], [full.outputs.index("w_g_m_s")]
    return LinearSystem(
        A=full.A[..., own, :][..., own],
        B=full.B[..., own, :][..., noise],
        C=-full.C[..., row, :][..., own],
        D=full.D[..., row, :][..., noise],
        states=tuple(full.states[i] for i in own),
        inputs=("noise_w",),
        outputs=("gust_m_s",),
    )


Matrices = tuple[Array, Array, Array]


def _check_model(model: str) -> None:
    if model not in _CORES:
        raise ValueError(f"unknown turbulence model {model!r}: use one of {', '.join(_CORES)}")


def _scaled(core: Matrices, T: Array, sigma: Array) -> Matrices:
    """A0/T, B0/sqrt(T), sigma C0 for every condition."""
    A0, B0, C0 = core
    T1, sigma1 = T[..., None, None], sigma[..., None, None]
    return A0 / T1, B0 / np.sqrt(T1), sigma1 * C0


def _with_rate(velocity: Matrices, limit: float, V: Array, sign: float) -> Matrices:
    """Append sign (s/V)/(1 + limit s/V) times the velocity: rate = sign (w - x)/limit, x' = (V/limit)(w - x)."""
    A, B, C = velocity
    n = A.shape[-1]
    speed = (V / limit)[..., None, None]
    A_rate = np.concatenate(
        [np.concatenate([A, np.zeros((*A.shape[:-1], 1))], -1), np.concatenate([speed * C, -speed], -1)], -2
    )
    B_rate = np.concatenate([B, np.zeros((*B.shape[:-2], 1, 1))], -2)
    C_rate = np.zeros((*C.shape[:-2], 2, n + 1))
    C_rate[..., :1, :n] = C
    C_rate[..., 1:, :n] = sign / limit * C
    C_rate[..., 1, n] = -sign / limit
    return A_rate, B_rate, C_rate


def _roll_rate(state: Turbulence, V: Array, span: float) -> Matrices:
    """First-order filter of p; its time constant is 4 b/(pi V)."""
    limit = rate_length("p", span)
    L = V * time_scale("p", V, state.length[..., 2], state.specification)
    level = state.intensity[..., 2] * np.sqrt(0.8 * np.pi / (V * L)) * (L / limit) ** (1.0 / 6.0)  # H_p at s = 0
    rate = (V / limit)[..., None, None]
    return -rate, np.sqrt(rate), np.sqrt(rate) * level[..., None, None]


def _assemble(blocks: list[Matrices], batch: tuple[int, ...], with_rates: bool) -> LinearSystem:
    """Block-diagonal system with outputs in the order u, v, w, p, q, r."""
    sizes = [A.shape[-1] for A, _, _ in blocks]
    rows = [C.shape[-2] for _, _, C in blocks]
    n, n_u, n_y = sum(sizes), len(blocks), sum(rows)
    A, B, C = np.zeros((*batch, n, n)), np.zeros((*batch, n, n_u)), np.zeros((*batch, n_y, n))
    at, row = 0, 0
    for j, (a, b, c) in enumerate(blocks):
        here = slice(at, at + sizes[j])
        A[..., here, here], B[..., here, j : j + 1] = a, b
        C[..., row : row + rows[j], here] = c
        at, row = at + sizes[j], row + rows[j]
    outputs = [f"{name}_g_m_s" for name in _VELOCITIES]
    if with_rates:  # the blocks give u | v r | w q | p
        C = C[..., [0, 1, 3, 5, 4, 2], :]
        outputs += [f"{name}_g_rad_s" for name in _RATES]
    names = ["u", "v", "w", "p"][:n_u]
    return LinearSystem(
        A=A,
        B=B,
        C=C,
        D=np.zeros((*batch, n_y, n_u)),
        states=tuple(f"x_{name}{k + 1}" for name, size in zip(names, sizes) for k in range(size)),
        inputs=tuple(f"noise_{name}" for name in names),
        outputs=tuple(outputs),
    )
