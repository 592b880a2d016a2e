"""Transmission zeros against transfer functions, pencils and the static reversal they cross at."""

from __future__ import annotations

import control
import numpy as np
import pytest
from scipy.linalg import eigvals

import aeroservo as av
from aeroservo.control.zeros import transmission_zeros, zeros_against_speed
from aeroservo.datatypes import FlightCondition, LinearSystem
from aeroservo.servo import Actuator


def system(A: object, B: object, C: object, D: object) -> LinearSystem:
    """A system with numbered channels."""
    A, B, C, D = (np.atleast_2d(np.asarray(m, dtype=float)) for m in (A, B, C, D))
    names = [tuple(f"{c}{i}" for i in range(k)) for c, k in (("x", len(A)), ("u", B.shape[1]), ("y", len(C)))]
    return LinearSystem(A=A, B=B, C=C, D=D, states=names[0], inputs=names[1], outputs=names[2])


@pytest.mark.parametrize(
    ("zeros", "poles"),
    [([], [-1, -2, -3]), ([5.0], [-1, -2, -3]), ([-3.0, 4.0], [-1, -2, -3]), ([0.0, 0.0, 7.0], [-1, -20, -300, -4])],
)
def test_zeros_of_a_transfer_function(zeros: list[float], poles: list[float]) -> None:
    """Numerators of every degree, states mixed by a random transformation of mixed scales."""
    tf = control.tf(2.5 * np.poly(zeros), np.poly(poles))
    ss = control.ss(tf)
    T = np.random.default_rng(0).standard_normal((len(poles), len(poles))) * np.geomspace(1e-3, 1e3, len(poles))
    one = system(T @ ss.A @ np.linalg.inv(T), T @ ss.B, ss.C @ np.linalg.inv(T), ss.D)
    found = transmission_zeros(one)
    assert np.sort(found.real) == pytest.approx(np.sort(zeros), abs=2e-4)
    assert len(found) == len(zeros)


def test_square_multivariable_zeros_are_those_of_the_pencil() -> None:
    """Two by two with D: the generalised eigenvalues of the Rosenbrock pencil."""
    draw = np.random.default_rng(4).standard_normal
    A, B, C, D = draw((4, 4)), draw((4, 2)), draw((2, 4)), draw((2, 2))
    pencil = eigvals(np.block([[A, B], [C, D]]), np.diag([1.0] * 4 + [0.0] * 2))
    finite = pencil[np.isfinite(pencil) & (np.abs(pencil) < 1e8)]
    found = transmission_zeros(system(A, B, C, D))
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(finite), rel=1e-8)
    tall = transmission_zeros(system(A, B[:, :1], C, np.zeros((2, 1))), output="y0")
    own = control.ss(A, B[:, :1], C[:1], 0).zeros()
    assert np.sort_complex(tall) == pytest.approx(np.sort_complex(own), rel=1e-8)


def test_plunge_zero_of_the_thesis_model() -> None:
    """It enters the right half plane at 53.3 m/s and is 4.6, 11.7, 20.8, 46 rad/s at 55, 60, 70, 110; pitch rate stays.

    equations.md, "Near reversal, what really changes sign". The crossing is the static reversal of lift, another route.
    """
    model = av.build(av.read("thesis-simulation"))
    sweep = FlightCondition.at(3048.0, V=[30.0, 45.0, 55.0, 60.0, 70.0, 110.0, 120.0])
    curves = {c.sensor: c for c in zeros_against_speed(model, sweep)}
    plunge = curves["plunge_m"]
    assert plunge.crossings == pytest.approx([53.3], abs=0.05)
    assert plunge.crossings[0] == pytest.approx(av.static(model, sweep).reversal.V, rel=1e-6)
    assert np.all(np.isnan(plunge.right[:2]))
    assert plunge.right[2:4] == pytest.approx([4.6, 11.7], abs=0.05)
    assert plunge.right[4] == pytest.approx(20.8, abs=0.05)
    assert plunge.right[5] == pytest.approx(46.0, abs=0.5)
    gyro = curves["pitch_rate_rad_s"]
    assert gyro.crossings == ()
    assert np.all(np.isnan(gyro.right))
    assert np.all(np.any(gyro.zeros == 0.0, axis=1))


def test_actuators_and_gains_add_no_zeros() -> None:
    """The same finite zeros with a second-order actuator; of BACT as python-control has them."""
    from dataclasses import replace

    bare = av.build(av.read("thesis-simulation"))
    moved = replace(bare, actuators=(Actuator(control="elevon", omega=60.0, zeta=0.7),))
    sweep = FlightCondition.at(0.0, V=[40.0, 60.0])
    for a, b in zip(zeros_against_speed(bare, sweep), zeros_against_speed(moved, sweep)):
        assert a.sensor == b.sensor
        assert b.zeros == pytest.approx(a.zeros, rel=1e-7, abs=1e-7)
    bact = av.build(av.read("bact"))
    found = zeros_against_speed(bact, FlightCondition.at(0.0, V=[90.0]), sensors=["acc_te"])[0].zeros[0]
    plant = av.linear_system(bact, FlightCondition.at(0.0, V=90.0))
    row = plant.outputs.index("acc_te_m_s2")
    own = control.ss(plant.A, plant.B[:, :1], plant.C[row : row + 1], plant.D[row : row + 1, :1]).zeros()
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(own), rel=1e-6, abs=1e-6)


def test_refusals() -> None:
    """Batches, unknown channels, inputs that do not reach their outputs."""
    one = system([[-1, 0], [0, -2]], [[1], [0]], [[0, 1]], [[0]])
    with pytest.raises(ValueError, match="does not reach"):
        transmission_zeros(one)
    with pytest.raises(ValueError, match="does not exist"):
        transmission_zeros(one, output="nowhere")
    batch = LinearSystem(
        A=np.zeros((2, 1, 1)), B=np.ones((2, 1, 1)), C=np.ones((2, 1, 1)), D=np.zeros((2, 1, 1)), states=("x",),
        inputs=("u",), outputs=("y",),
    )  # fmt: skip
    with pytest.raises(ValueError, match="one condition"):
        transmission_zeros(batch)
