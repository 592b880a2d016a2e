"""Dryden turbulence of JSBSim against ours: a free program that many simulators fly with.

Its default (turbulence type 3, "Milspec") is the first-order digital form of MIL-STD-1797A, which has 4/3 of the
vertical spectrum of MIL-F-8785C above its corner; its other form (type 4, "Tustin") discretises the true filter by the
bilinear rule. Intensity and scale length at 5,000 ft, moderate (P = 1e-3), are read out of both.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import welch

from aeroservo.gust.intensity import turbulence
from aeroservo.gust.sampling import discrete_psd, discretise
from aeroservo.gust.turbulence import component_psd, vertical_filter

jsbsim = pytest.importorskip("jsbsim", reason="JSBSim is not installed (pip install jsbsim; the test extra has it)")

FT = 0.3048
V, ALTITUDE, DT, DURATION, SEEDS = 50.0, 5000.0 * FT, 0.01, 400.0, 6
MILSPEC, TUSTIN = 3, 4
BANDS = ((0.2, 0.5), (0.5, 2.0), (2.0, 5.0), (5.0, 10.0))  # [Hz]
#: Its airspeed wanders by 2 % about 50 m/s (the turbulence itself blows in it), and the estimate scatters.
MODEL_GAP = 0.03

BOX = """<?xml version="1.0"?>
<fdm_config name="box" version="2.0" release="ALPHA">
 <fileheader><author>test</author><description>A mass that flies straight on</description></fileheader>
 <metrics><wingarea unit="FT2">100</wingarea><wingspan unit="FT">10</wingspan><chord unit="FT">5</chord>
  <location name="AERORP" unit="IN"><x>0</x><y>0</y><z>0</z></location></metrics>
 <mass_balance>
  <ixx unit="SLUG*FT2">1e9</ixx><iyy unit="SLUG*FT2">1e9</iyy><izz unit="SLUG*FT2">1e9</izz>
  <emptywt unit="LBS">32174</emptywt><location name="CG" unit="IN"><x>0</x><y>0</y><z>0</z></location></mass_balance>
 <ground_reactions/><propulsion/><flight_control name="none"/>
 <aerodynamics><axis name="LIFT"/><axis name="DRAG"/><axis name="SIDE"/></aerodynamics>
 <external_reactions><force name="hold" frame="LOCAL"><location unit="IN"><x>0</x><y>0</y><z>0</z></location>
  <direction><x>0</x><y>0</y><z>-1</z></direction></force></external_reactions>
</fdm_config>
"""


def record(root: Path, kind: int, seed: int) -> np.ndarray:
    """Vertical gust, down, at every step of a mass held at altitude. [m/s]"""
    fdm = jsbsim.FGFDMExec(str(root), None)
    fdm.set_debug_level(0)
    fdm.set_aircraft_path("aircraft")
    assert fdm.load_model("box")
    fdm.set_dt(DT)
    fdm["ic/h-sl-ft"], fdm["ic/vt-fps"] = ALTITUDE / FT, V / FT
    fdm.run_ic()
    fdm["simulation/randomseed"] = seed
    fdm["atmosphere/turb-type"] = kind
    fdm["atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps"] = 50.0
    fdm["atmosphere/turbulence/milspec/severity"] = 4  # P = 1e-3
    out = np.empty(round(DURATION / DT))
    for k in range(out.size):
        hold = 60.0 * (fdm["position/h-sl-ft"] - ALTITUDE / FT) + 500.0 * fdm["velocities/h-dot-fps"]
        fdm["external_reactions/hold/magnitude"] = fdm["inertia/weight-lbs"] - hold
        fdm.run()
        out[k] = fdm["atmosphere/turb-down-fps"] * FT
    assert abs(fdm["position/h-sl-ft"] * FT - ALTITUDE) < 5.0
    return out


def band_means(root: Path, kind: int) -> tuple[np.ndarray, np.ndarray]:
    """Spectrum of the records over the specification's, band by band, and the standard error of it."""
    state = turbulence(ALTITUDE, severity="moderate")
    rows = []
    for seed in range(1, SEEDS + 1):
        f, power = welch(record(root, kind, seed), fs=1.0 / DT, nperseg=8192, detrend=False)
        exact = 2.0 * np.pi * component_psd(2.0 * np.pi * f[1:], state, V, component="w")
        inside = [(f[1:] >= low) & (f[1:] < high) for low, high in BANDS]
        rows.append([power[1:][mask].mean() / exact[mask].mean() for mask in inside])
    table = np.array(rows)
    return table.mean(axis=0), table.std(axis=0, ddof=1) / np.sqrt(SEEDS)


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A folder that JSBSim takes its aircraft from."""
    (tmp_path / "aircraft" / "box").mkdir(parents=True)
    (tmp_path / "aircraft" / "box" / "box.xml").write_text(BOX, encoding="utf-8")
    return tmp_path


def test_the_default_has_a_third_too_much_power(root: Path) -> None:
    """4/3 of the true vertical spectrum from 0.5 to 10 Hz (folding at its 10 ms adds 0.2 % there)."""
    ratio, error = band_means(root, MILSPEC)
    np.testing.assert_array_less(np.abs(ratio[1:] - 4.0 / 3.0), 3.0 * error[1:] + MODEL_GAP * 4.0 / 3.0)
    assert np.all(ratio[1:] > 1.25)


def test_tustins_form_is_the_same_turbulence_as_ours(root: Path) -> None:
    """Below 5 Hz the spectrum of the specification: so scale length, intensity table and filter are the same as ours.

    The bilinear rule loses power towards half the sample rate: (2/(w dt) tan(w dt/2))^-2 of the slope, 0.97 at 10 Hz.
    """
    ratio, error = band_means(root, TUSTIN)
    np.testing.assert_array_less(np.abs(ratio[:3] - 1.0), 3.0 * error[:3] + MODEL_GAP)
    assert ratio[3] < 1.0
    state = turbulence(ALTITUDE, severity="moderate")
    ours = discretise(vertical_filter(state, V), DT)
    omega = 2.0 * np.pi * np.array([0.5, 2.0, 5.0])
    np.testing.assert_allclose(
        discrete_psd(ours, omega)[:, 0], component_psd(omega, state, V, component="w"), rtol=0.02
    )  # ours at the same 10 ms: folded, exactly
