"""Taper and washout against the elliptic loading: classical results, and the thesis' choice of 0.4."""

import numpy as np
import pytest

from aeroservo.aero.vlm import VortexLattice
from aeroservo.studies.loading import loading_study

TAPERS = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0])
OPTIONS = VortexLattice(chordwise=4, spanwise=24)


def test_unswept_wings_have_glauert_s_taper():
    """Lifting-line theory (Glauert 1926): least induced drag at a taper of 0.3 to 0.45, close to the ellipse."""
    found = loading_study(aspect_ratio=20.0, sweep=0.0, taper=TAPERS, washout=[0.0], CL=0.4, method=OPTIONS)
    best = TAPERS[np.argmax(found.efficiency[:, 0])]
    assert 0.3 <= best <= 0.45
    assert 0.97 < found.efficiency.max() < 0.995
    assert np.all(found.efficiency < 1.0005)  # nothing planar beats the ellipse
    # the shape says the same as the drag
    assert abs(int(np.argmin(found.deviation[:, 0])) - int(np.argmax(found.efficiency[:, 0]))) <= 1


def test_sweep_wants_another_taper_than_0_4():
    """Sweep loads the tips: a smaller taper is nearest the ellipse, unless washout takes the load off them."""
    washout = np.radians([0.0, -2.5, -5.0])
    found = loading_study(
        aspect_ratio=4.0, sweep=np.radians(23.0), taper=TAPERS, washout=washout, CL=0.3, method=OPTIONS
    )
    straight = loading_study(aspect_ratio=4.0, sweep=0.0, taper=TAPERS, washout=[0.0], CL=0.3, method=OPTIONS)
    assert TAPERS[np.argmax(found.efficiency[:, 0])] < TAPERS[np.argmax(straight.efficiency[:, 0])]
    thesis = int(np.argmin(np.abs(TAPERS - 0.4)))
    assert found.efficiency[thesis, 0] > 0.98
    # washout keeps the tips from stalling first, the more the lower the taper needs it
    assert np.all(np.diff(found.tip_margin[thesis]) > 0)
    # and for every taper the efficiency is a parabola of the washout: two solves, any number of washouts
    three = loading_study(
        aspect_ratio=4.0, sweep=np.radians(23.0), taper=[0.4], washout=washout, CL=0.3, method=OPTIONS
    )
    np.testing.assert_allclose(three.efficiency[0], found.efficiency[thesis], rtol=1e-12)


def test_induced_drag_is_a_parabola_of_the_washout():
    washout = np.linspace(-0.1, 0.05, 7)
    found = loading_study(aspect_ratio=4.0, sweep=0.4, taper=[0.43], washout=washout, CL=0.3, method=OPTIONS)
    drag = 1 / found.efficiency[0]
    np.testing.assert_allclose(np.polyval(np.polyfit(washout, drag, 2), washout), drag, rtol=1e-10)
    with pytest.raises(ValueError, match="must be > 0"):
        loading_study(aspect_ratio=4.0, sweep=0.0, taper=[0.0], washout=[0.0], CL=0.3)
