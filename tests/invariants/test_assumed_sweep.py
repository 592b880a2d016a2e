"""The thesis' wings swept: V cos(Lambda) and nothing else, so every speed grows as 1 / cos(Lambda)."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, P, flutter
from aeroservo.aeroelastic.static import static
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import FlightCondition

TWO_ROUTES = 1e-7  # C(k) is a spline whose nodes lie elsewhere on the swept wing


@pytest.mark.parametrize(("preset", "aero"), [("thesis-binary", None), ("thesis-aircraft", "theodorsen")])
@pytest.mark.parametrize("sweep_deg", [-25.0, 20.0])
def test_speeds_grow_as_the_inverse_cosine(preset, aero, sweep_deg):
    straight = read(preset)
    swept = override(straight, {"wing.sweep_deg": sweep_deg})
    cos = np.cos(np.deg2rad(sweep_deg))
    method = P() if aero is None else PK()
    V = np.linspace(1.0, 120.0, 60)
    one = flutter(build(straight, aero), FlightCondition(V=V, rho=1.2), method)
    two = flutter(build(swept, aero), FlightCondition(V=V / cos, rho=1.2), method)
    assert two.flutter_speed * cos == pytest.approx(one.flutter_speed, rel=TWO_ROUTES)
    assert two.flutter_frequency == pytest.approx(one.flutter_frequency, rel=TWO_ROUTES)
    still, leaning = (static(build(m, aero), FlightCondition(V=V, rho=1.2)) for m in (straight, swept))
    for quantity in ("divergence", "reversal"):
        assert getattr(leaning, quantity).V * cos == pytest.approx(getattr(still, quantity).V, rel=TWO_ROUTES)
