"""Turbulence in the engine: one frozen field for all zones, along flights that change, and the Blockset's defaults."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import welch

from aeroservo.gust.intensity import constant_turbulence
from aeroservo.gust.turbulence import component_psd
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.profiles import Profile, climb, level
from aeroservo.simulate.stream import TurbulenceStream

DT = 1e-3


def stream(weather: Gustiness, profile: Profile, offsets: list[float], seed: int, dt: float = DT) -> TurbulenceStream:
    """A stream of its own."""
    return TurbulenceStream(weather, profile, dt, np.array(offsets), np.random.default_rng(seed))


@pytest.mark.parametrize("offsets", [[0.0], [-0.3, 0.0, 1.2345]])
@pytest.mark.parametrize("model", ["dryden", "von_karman", "dryden_blockset"])
def test_pieces_are_one_record(offsets: list[float], model) -> None:
    """Made at once or in pieces of 700 steps."""
    weather, profile = Gustiness(level=1.5, model=model), level(40.0)
    t = DT * np.arange(4200)
    whole = stream(weather, profile, offsets, 3).at(t)
    one = stream(weather, profile, offsets, 3)
    np.testing.assert_allclose(np.concatenate([one.at(part) for part in np.split(t, 6)]), whole, atol=1e-12)
    assert whole.shape == (4200, len(offsets))


@pytest.mark.parametrize("profile", [level(30.0), climb(V=(20.0, 60.0), altitude=(500.0, 700.0), duration=12.0)])
def test_a_zone_aft_meets_what_the_first_has_met(profile: Profile) -> None:
    """At the same place of the frozen field, whatever the airspeed has done since; cubic between samples."""
    reach = 3.21
    w = stream(Gustiness(level=1.0), profile, [0.0, reach], 1).at(DT * np.arange(12_000))
    t = DT * np.arange(12_000)
    place = profile.distance(t)
    later = np.interp(place + reach, place, t)  # when the aft zone is where the first is at t
    inside = later < t[-1] - 0.01
    again = np.interp(later[inside], t, w[:, 1])
    rough = np.abs(np.diff(w[:, 0])).max()  # of one step: straight lines here against cubics there
    assert np.abs(again - w[inside, 0]).max() < 0.5 * rough
    assert np.corrcoef(again, w[inside, 0])[0, 1] > 0.9999  # 0.9994 if it were one step off
    assert w[:, 1].std() == pytest.approx(w[:, 0].std(), rel=0.1)


@pytest.mark.parametrize("model", ["dryden", "von_karman"])
def test_along_a_climb_the_intensity_follows_the_tables(model) -> None:
    """Speed, length and intensity change together: w over the local sigma has variance 1, over the seeds.

    And it is one frozen field: the correlation over a way x is that of the length at hand, (1 - x/2L) e^(-x/L).
    """
    weather = Gustiness(level="moderate", model=model)
    profile = climb(V=(30.0, 120.0), altitude=(100.0, 3000.0), duration=60.0)
    dt, seeds = 0.02, 200 if model == "dryden" else 60
    t = dt * np.arange(3000)
    altitude = np.interp(t, profile.t, profile.altitude)
    state = weather.state(altitude)
    scaled = np.stack([stream(weather, profile, [0.0], s, dt).at(t)[:, 0] for s in range(seeds)])
    scaled = scaled / state.intensity[:, 2]
    for part in (scaled[:, :600], scaled[:, 1200:1800], scaled[:, 2400:]):
        mean_square = (part**2).mean(axis=1)
        error = mean_square.std(ddof=1) / np.sqrt(seeds)
        assert abs(mean_square.mean() - 1.0) < 3.5 * error + 0.005
        assert error < 0.2
    if model == "dryden":
        place = profile.distance(t)
        for begin, way in ((300, 20.0), (1500, 100.0), (2000, 200.0)):
            end = int(np.searchsorted(place, place[begin] + way))
            x, L = place[end] - place[begin], state.length[[begin, end], 2].mean()
            products = scaled[:, begin] * scaled[:, end]
            expected = (1.0 - x / (2.0 * L)) * np.exp(-x / L)
            assert abs(products.mean() - expected) < 3.5 * products.std(ddof=1) / np.sqrt(seeds) + 0.02


def test_the_blocksets_defaults_in_the_engine_lose_the_flutter_band() -> None:
    """Noise held for 0.1 s: 0.875, 0.405 and nothing of the spectrum at 2, 5 and 10 Hz; it starts from rest."""
    weather, power = Gustiness(level=1.0, model="dryden_blockset"), 0.0
    t = 2.0 * DT * np.arange(150_000)
    for seed in range(6):
        w = stream(weather, level(50.0), [0.0], seed, 2.0 * DT).at(t)[:, 0]
        assert w[0] == 0.0
        f, one = welch(w[10_000:], fs=500.0, nperseg=5_000, detrend=False)
        power = power + one / 6.0
    exact = 2.0 * np.pi * component_psd(2.0 * np.pi * f[1:], constant_turbulence(1.0), 50.0, component="w")
    for centre, share in ((2.0, 0.875), (5.0, 0.405)):
        near = (f[1:] > 0.9 * centre) & (f[1:] < 1.1 * centre)
        assert power[1:][near].mean() / exact[near].mean() == pytest.approx(share, rel=0.1)
    near = (f[1:] > 9.7) & (f[1:] < 10.3)
    assert power[1:][near].mean() / exact[near].mean() < 0.02


def test_names_are_checked() -> None:
    """Unknown spectrum and specification, negative intensity, below ground."""
    for call, words in (
        (lambda: Gustiness(level=1.0, model="kaimal"), "turbulence model must be one of dryden"),
        (lambda: Gustiness(level=1.0, specification="MIL"), "turbulence specification must be one of MIL-F-8785C"),
        (lambda: Gustiness(level=-1.0), "must not be negative"),
        (lambda: Gustiness(level=1.0).state(np.array([-5.0])), "below ground"),
        (lambda: Gustiness(level="light").state(np.array([-5.0])), "below ground"),
    ):
        with pytest.raises(ValueError, match=words):
            call()
    block = Gustiness(level=1.0, model="von_karman_blockset")
    assert (block.noise_step, block.filter) == (0.1, "von_karman_blockset")
    assert Gustiness(level="severe", model="von_karman").state(np.array([3e3])).length[0, 2] == pytest.approx(762.0)
