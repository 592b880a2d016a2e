"""Figures 9 to 11, 31 and 32 of the thesis beside ours, and its claims about the linear model of its appendix."""

from __future__ import annotations

import numpy as np

from aeroservo.datatypes import Array
from aeroservo.studies.thesis_linear import GAIN, Appendix, free_response
from aeroservo.studies.thesis_records import Claim, Compared, Curve, Entry, Plot, verdict

SHOWN = 10.0
"""Of the growing motion. [s]"""
KINDS = (
    ("real, negative", -1.0, 0.0),
    ("real, zero", 0.0, 0.0),
    ("real, positive", 0.3, 0.0),
    ("pair, negative real part", -0.4, 6.0),
    ("pair, zero real part", 0.0, 6.0),
    ("pair, positive real part", 0.3, 6.0),
)
"""Kinds of roots: name, growth, frequency. [1/s, rad/s]"""


def linear_entries(a: Appendix) -> tuple[Entry, ...]:
    """Figures 9, 10, 11, 31 and 32.

    Parameters
    ----------
    a : Appendix
        Of `thesis_appendix`.

    Returns
    -------
    entries : tuple of Entry
        In the thesis' order.
    """
    return _figure_9(), _figure_10(a), _figure_11(a), _figure_31(a), _figure_32(a)


def _pair(root: Array) -> complex:
    """The least damped root that swings, upper half plane; the least damped where none does."""
    swinging = root[root.imag > 1e-9]
    pool = swinging if swinging.size else root
    return complex(pool[int(np.argmax(pool.real))])


def _text(root: complex) -> str:
    """A root in words."""
    return f"{root.real:+.3f}" + (f" ± {abs(root.imag):.3f}i" if abs(root.imag) > 1e-9 else "")


def _figure_9() -> Entry:
    """Free motion of one root of each kind, from the exponential of its matrix."""
    t = np.linspace(0.0, 5.0, 501)
    curves, rows = [], []
    for name, sigma, omega in KINDS:
        if omega:
            y = free_response(np.array([[sigma, omega], [-omega, sigma]]), np.array([1.0, 0.0]), t)[:, 0]
        else:
            y = free_response(np.array([[sigma]]), np.array([1.0]), t)[:, 0]
        curves.append(Curve(name=name, x=t, y=y))
        late, early = np.abs(y[t > 2.5]).max(), np.abs(y[t <= 2.5]).max()
        ours = "grows" if late > 1.001 * early else "dies out" if late < 0.999 * early else "stays"
        said = "unstable" if sigma > 0.0 else "stable" if sigma < 0.0 else "neutral"
        rows.append(Compared(what=name, unit="", thesis=said, ours=ours, reason="free motion of such a root"))
    return Entry(
        number="Fig. 9",
        title="Position of poles and stability",
        thesis="A positive real part is unstable; an imaginary part makes the motion oscillate (6.5).",
        finding="One free motion for each kind of root.",
        compared=tuple(rows),
        plots=(
            Plot(
                title="Free motion of a root", x_label="time, s", y_label="displacement", curves=tuple(curves),
                y_range=(-3.0, 4.5),
            ),
        ),
    )  # fmt: skip


def _figure_10(a: Appendix) -> Entry:
    """Full state feedback: A - B K."""
    return Entry(
        number="Fig. 10",
        title="Full state feedback",
        thesis="u = -K x makes A - B K of A (6.8, 6.9); the appendix prints A, B, K and A - B K.",
        finding=f"A - B K of the printed matrices agrees with the printed one to {a.closed_error:.2f} of what "
        "rounding to four "
        f"digits allows. K = lqr(A, B, I, 1) to {a.gain_error:.1e}; the smallest |1 + L| is {a.least_return:.6f}.",
        compared=tuple(
            Compared(what=f"K_{i + 1}", unit="", thesis=float(GAIN[0, i]), ours=float(a.K[0, i]), reason="Q = I, R = 1")
            for i in range(GAIN.shape[1])
        ),
        unsound="The printed A has +1 where its own A - B K has -1 (pitch into the lag state), which no K can "
        "change: B is "
        f"zero in that row. With +1 the plant has one real unstable root, {_text(_real(a.misprinted_roots))}, and no "
        "growing "
        "oscillation; Figures 31 and 32 follow only with -1. "
        "Equation 7.69 feeds back integrals of plunge and of pitch through one elevon: the rank test gives "
        f"{a.integrals[0]} "
        f"of {a.integrals[1]}, so one of the two integrals cannot be moved and its root stays at zero. A leaky "
        "integral of "
        "one of them, as the appendix has it for pitch, is sound.",
    )


def _real(roots: Array) -> complex:
    """The root farthest to the right that does not swing."""
    still = roots[np.abs(roots.imag) < 1e-9]
    return complex(still[int(np.argmax(still.real))])


def _figure_11(a: Appendix) -> Entry:
    """Properties of eigenvalues, with the thesis' own."""
    sets = (
        ("without control", a.open_roots),
        ("with control", a.closed_roots),
        ("without the loop hidden in A", a.bare_roots),
    )
    rows = []
    for name, roots in sets:
        for root in sorted(roots[roots.imag >= -1e-9], key=lambda s: -s.real):
            kind = ("growing" if root.real > 0.0 else "decaying") + (
                " oscillation" if abs(root.imag) > 1e-9 else " exponential"
            )
            rows.append(Compared(what=f"{name}: {_text(root)}", unit="1/s", thesis=None, ours=kind))
    return Entry(
        number="Fig. 11",
        title="Properties of eigenvalues",
        thesis="Real or complex, negative or positive: how a system behaves.",
        finding="The roots of the appendix' model, each with its behaviour.",
        compared=tuple(rows),
        plots=(
            Plot(
                title="Roots of the appendix' model", x_label="Re, 1/s (positive: unstable)", y_label="Im, rad/s",
                curves=tuple(Curve(name=name, x=roots.real, y=roots.imag, points=True) for name, roots in sets),
                marks=((0.0, "border of stability"),),
            ),
        ),
    )  # fmt: skip


def _states(t: Array, x: Array, words: str) -> tuple[Plot, Plot]:
    """Plunge and pitch of a response."""
    return tuple(
        Plot(
            title=f"{title}, {words}", x_label="time, s", y_label=label,
            curves=(Curve(name=title, x=t, y=factor * x[:, column]),),
        )
        for title, label, column, factor in (
            ("plunge", "plunge (down), cm", 1, 100.0),
            ("pitch", "pitch (nose up), deg", 2, 180.0 / np.pi),
        )
    )  # type: ignore[return-value]  # fmt: skip


def _figure_31(a: Appendix) -> Entry:
    """The linear model without control."""
    root, bare = _pair(a.open_roots), _real(a.bare_roots)
    return Entry(
        number="Fig. 31",
        title="Linear model without control",
        thesis="After a disturbance the response oscillates with growing amplitude: no stable flight, because of "
        "relaxed "
        "static stability.",
        finding=f"Root {_text(root)}: a period of {2 * np.pi / root.imag:.2f} s, doubling every "
        f"{np.log(2) / root.real:.2f} s.",
        plots=_states(a.t[a.t <= SHOWN], a.free[a.t <= SHOWN], "1 degree of pitch, no control"),
        unsound=f"The first columns of A and B are parallel, ratio {a.ratio:.3f}: the model 'without control' "
        "already holds a "
        "loop from a pitch lag to the elevon, and that loop makes the oscillation. Without it the plant has one real "
        f"unstable root, {_text(bare)} (relaxed static stability), which grows without oscillating.",
    )


def _figure_32(a: Appendix) -> Entry:
    """The linear model with the LQR."""
    root = _pair(a.closed_roots)
    return Entry(
        number="Fig. 32",
        title="Step response of the linear model with LQR",
        thesis="The optimal gain settles in around 6 s.",
        finding=f"Root {_text(root)}: 4/{-root.real:.3f} = {4 / -root.real:.2f} s; plunge after a disturbance stays "
        "within 2 % of "
        f"its peak from {a.settling:.2f} s on.",
        compared=(
            Compared(
                what="settling time, 4 over the decay", unit="s", thesis=6.0, ours=4.0 / -root.real, reason="'around 6'"
            ),
            Compared(what="settling time, 2 % of the peak", unit="s", thesis=6.0, ours=a.settling, reason="'around 6'"),
        ),
        plots=(*_states(a.t, a.step, "unit step of the command"), *_states(a.t, a.held, "1 degree of pitch")),
    )


def linear_claims(a: Appendix) -> tuple[Claim, ...]:
    """Claims about the linear model.

    Parameters
    ----------
    a : Appendix
        Of `thesis_appendix`.

    Returns
    -------
    claims : tuple of Claim
        In the thesis' order.
    """
    root, bare, closed = _pair(a.open_roots), _real(a.bare_roots), _pair(a.closed_roots)
    settle = (4.0 / -closed.real, a.settling)
    rank, needed = a.integrals
    return (
        Claim(
            section="7.11, Eq. 7.69",
            statement="integrals of plunge and pitch remove both steady errors with one elevon",
            verdict=verdict(whole=rank == needed, part=False),
            numbers=f"rank {rank} of {needed} needed: with one elevon one integral at most can be moved",
        ),
        Claim(
            section="9.4.1, Fig. 31",
            statement="without control the model is not capable of stable flight, because of relaxed static stability",
            verdict=verdict(whole=bare.real > 0.0 and root.real > 0.0 and abs(root.imag) < 1e-9, part=bare.real > 0.0),
            numbers=f"bare plant {_text(bare)} 1/s: statically unstable; the growing oscillation of the figure, "
            f"{_text(root)}, "
            "is that of the pitch-lag loop inside the model",
        ),
        Claim(
            section="9.4.2, Fig. 32",
            statement="with the LQR it settles in about 6 s",
            verdict=verdict(whole=all(5.0 <= s <= 7.0 for s in settle)),
            numbers=f"{settle[0]:.2f} s by its root, {settle[1]:.2f} s by 2 % of the peak; |1 + L| >= "
            f"{a.least_return:.4f}",
        ),
        Claim(
            section="9.4.2, appendix",
            statement="K is the optimal gain of the printed model",
            verdict=verdict(whole=a.gain_error < 2e-4 and a.closed_error < 1.0, part=a.gain_error < 1e-2),
            numbers=f"K = lqr(A, B, I, 1) to {a.gain_error:.1e} once one sign of A is put right; A - B K within "
            f"{a.closed_error:.2f} of its rounding",
        ),
    )
