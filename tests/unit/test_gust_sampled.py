"""Gust loads with a sampled controller in the loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aircraft.files import read
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.datatypes import FlightCondition
from aeroservo.gust.intensity import constant_turbulence
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import run_prepared
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.gust_loads import design_velocity, gust_loads
from aeroservo.studies.gust_plant import gust_plant
from aeroservo.studies.gust_sampled import sampled_gust_loads
from aeroservo.studies.root_loads import with_loads

UNIT = design_velocity("unit", altitude=None, density=1.0)
STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
#: LQR gains for the thesis' simulation model, u = -K x; 55 m/s at 10,000 ft is beyond its flutter speed.
GAINS = -np.array([[6.783, 1.69, 0.573, 0.916]])
HIGH = FlightCondition.at(3048.0, V=55.0)


def law(dt: float | None, gains: np.ndarray = GAINS) -> Controller:
    """u = -K x, sampled or not."""
    return state_feedback(gains, STATES, ("elevon_command_rad",), dt)


def test_fast_samples_are_the_continuous_loop() -> None:
    """RMS and peaks tend to those of the continuous loop as the sample shortens."""
    model = av.build(read("thesis-simulation"))
    plant = gust_plant(model, HIGH, controller=law(None))
    wanted = gust_loads(plant, gradients=[10.0], velocity=UNIT, bounds=None)
    assert wanted.stable and gust_plant(model, HIGH).growth > 0.0  # open loop it flutters
    i = [plant.outputs.index(name) for name in (*STATES, "elevon_rad")]
    error = []
    for dt in (2e-3, 1e-3):
        found = sampled_gust_loads(model, HIGH, law(dt), gradients=[10.0], velocity=UNIT)
        j = [found.channels.index(name) for name in (*STATES, "elevon_rad")]
        error.append(
            (np.abs(found.rms[j] / wanted.rms[i] - 1.0).max(), np.abs(found.peak[0, j] / wanted.peak[0, i] - 1.0).max())
        )
    assert max(error[1]) < 0.02
    assert error[1][0] == pytest.approx(0.5 * error[0][0], rel=0.2)  # first order: half a sample of delay


def test_rms_is_that_of_simulated_turbulence() -> None:
    """A slow sample with half a sample of computing delay: sixteen runs of 60 s within 3 standard errors."""
    model = replace(av.build(read("thesis-simulation")), springs=(), lift_curve=None, gravity=None, limits=())
    controller = replace(law(0.008), delay_s=0.004)
    found = sampled_gust_loads(model, HIGH, controller, gradients=[10.0], velocity=UNIT)
    assert found.stable and found.critical is None
    flight = level(55.0, density=float(HIGH.rho))
    scenario = Scenario(
        profile=flight, duration=65.0, turbulence=Gustiness(level=1.0), controller=controller, initial=()
    )
    prepared = prepare(model, scenario, Stepping(record_s=0.008))
    names = ("plunge_m", "pitch_rad", "pitch_rate_rad_s", "elevon_rad")
    rows = []
    for seed in range(16):
        history = run_prepared(prepared, seed=seed).history
        assert history is not None
        rows.append([np.mean(history[name][history.t > 5.0] ** 2) for name in names])
    squares = np.array(rows)
    error = squares.std(axis=0, ddof=1) / 4.0
    wanted = np.array([found.rms[found.channels.index(name)] ** 2 for name in names])
    assert np.all(np.abs(squares.mean(axis=0) - wanted) < 3.0 * error)
    assert np.all(error < 0.15 * wanted)


def test_loads_notes_and_refusals() -> None:
    """Springs have an RMS; an unstable loop has nothing but a note; channels that are missing are named."""
    model, loads = with_loads(read("thesis-simulation"))
    found = sampled_gust_loads(
        model, HIGH, law(0.002), gradients=[5.0, 20.0], velocity=UNIT, loads=loads, turbulence=constant_turbulence(1.0)
    )
    spring = found.channels.index("plunge_spring_N")
    plunge = found.channels.index("plunge_m")
    assert found.rms[spring] == pytest.approx(float(model.modes.K[0, 0]) * found.rms[plunge], rel=1e-9)
    assert np.isnan(found.peak[0, spring]) and found.peak[0, plunge] > 0.0
    assert any("instants" in note for note in found.notes) and any("infinite" in note for note in found.notes)
    bad = sampled_gust_loads(model, HIGH, law(0.002, -GAINS), gradients=[5.0], velocity=UNIT)
    assert not bad.stable and np.all(np.isnan(bad.peak)) and "unstable at 55 m/s" in bad.notes[-1]
    with pytest.raises(ValueError, match="gradients must be positive"):
        sampled_gust_loads(model, HIGH, law(0.002), gradients=[-1.0], velocity=UNIT)
    with pytest.raises(ValueError, match="reads 'yaw_rad'"):
        sampled_gust_loads(
            model, HIGH, replace(law(0.002), inputs=("yaw_rad", *STATES[1:])), gradients=[5.0], velocity=UNIT
        )
