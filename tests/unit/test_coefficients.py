"""Coefficients: moved, rescaled, read from a tunnel's file, against the lattice solved anew."""

import numpy as np
import pytest

from aeroservo.aero.coefficients import (
    AeroCoefficients,
    CoefficientTable,
    Reference,
    body_axes,
    coefficients_about,
    coefficients_on,
    wind_axes,
)
from aeroservo.aero.coefficients_csv import linear_fit, read_coefficients
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice, lattice_coefficients
from aeroservo.aircraft.files import read
from aeroservo.aircraft.geometry import ReferenceQuantities

TWO_ROUTES = 1e-9  # converted coefficients against a lattice solved with the new references

OPTIONS = VortexLattice(chordwise=6, spanwise=12)


def solved(**change):
    model = read("thesis-uav")
    r = model.references()
    fields = {"S": r.S, "c": r.c, "b": r.b, "x": r.x, "y": 0.0, "z": r.z} | change
    return lattice_coefficients(aircraft_lattice(model.surfaces(), ReferenceQuantities(**fields), method=OPTIONS))


def assert_same(a, b):
    for name in ("CL0", "CM0", "CL_alpha", "CM_alpha", "CL_q", "CM_q", "CL_delta", "CM_delta", "span_efficiency"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=TWO_ROUTES, atol=TWO_ROUTES, err_msg=name)


def test_moving_the_point_is_solving_about_it():
    assert_same(coefficients_about(solved(), (0.6, 0.0, 0.0)), solved(x=0.6))
    there_and_back = coefficients_about(coefficients_about(solved(), (0.6, 0, 0)), (solved().reference.x, 0, 0))
    assert_same(there_and_back, solved())
    with pytest.raises(ValueError, match="x and z only"):
        coefficients_about(solved(), (0.0, 1.0, 0.0))


def test_new_references_are_solving_on_them():
    moved = coefficients_on(solved(), S=1.7, c=0.4, b=2.5, rates="c/(2V)")
    assert_same(moved, solved(S=1.7, c=0.4, b=2.5))
    raw = coefficients_on(solved(), S=1.0, c=solved().reference.c, b=2.0, rates="1/V")
    assert raw.CL_q == pytest.approx(solved().CL_q * solved().reference.c / 2)
    with pytest.raises(ValueError, match="rates"):
        coefficients_on(solved(), S=1.0, c=1.0, b=1.0, rates="b/2V")


def test_neutral_point_does_not_depend_on_the_point():
    a = solved()
    assert coefficients_about(a, (1.3, 0.0, 0.0)).neutral_point == pytest.approx(a.neutral_point, rel=TWO_ROUTES)


def test_axes_turn_back():
    rng = np.random.default_rng(0)
    CL, CD, alpha = rng.normal(size=20), rng.random(20), rng.uniform(-1, 1, 20)
    back = wind_axes(*body_axes(CL, CD, alpha), alpha)
    np.testing.assert_allclose(back, [CL, CD], atol=1e-12)


def tunnel_file(path, body=False):
    """A wing with CL = 0.1 + 4.2 a + 0.8 d, CM = 0.02 - 0.3 a - 0.3 d about x = 0.3, CD = 0.02 + 0.1 CL^2."""
    a, d = np.meshgrid(np.radians(np.arange(-4, 5, 2.0)), np.radians([-5.0, 0.0, 5.0]))
    CL = 0.1 + 4.2 * a + 0.8 * d
    CD, CM = 0.02 + 0.1 * CL**2, 0.02 - 0.3 * a - 0.3 * d
    lines = ["# tunnel test", "alpha_deg, delta_deg, " + ("CN, CA, CM" if body else "CL, CD, CM")]
    first, second = body_axes(CL, CD, a) if body else (CL, CD)
    columns = (np.degrees(a), np.degrees(d), first, second, CM)
    lines += [", ".join(f"{v:.12g}" for v in row) for row in zip(*(c.ravel() for c in columns))]
    path.write_text("\n".join(lines[:-1]) + "\n")  # the last point is missing: grids need not be full
    return path


@pytest.mark.parametrize("body", [False, True])
def test_wind_tunnel_file(tmp_path, body):
    ref = Reference(S=1.0, c=0.5, b=2.0, point=(0.3, 0.0, 0.0))
    found = read_coefficients(tunnel_file(tmp_path / "t.csv", body), ref)
    values = [found.CL0, found.CL_alpha, found.CL_delta[0], found.CM0, found.CM_alpha, found.CM_delta[0]]
    np.testing.assert_allclose(values, [0.1, 4.2, 0.8, 0.02, -0.3, -0.3], atol=1e-9)
    assert found.CL_q is None and found.table is not None
    assert np.isnan(found.table.CL).sum() == 1
    moved = coefficients_about(found, (found.neutral_point, 0.0, 0.0))
    assert moved.CM_alpha == pytest.approx(0.0, abs=1e-9)
    # the moved table is the moved linear model, but for the axial force and the cosine
    fit = linear_fit(moved.table, alpha_range=(-0.07, 0.07), delta_range=(-0.1, 0.1))
    assert fit.CM_alpha == pytest.approx(moved.CM_alpha, abs=0.01)
    assert fit.CL_residual < 1e-9


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("alpha_deg,CL\n0,0\n", "missing: CM"),
        ("alpha_deg,CM\n0,0\n", r"missing: CL \(or CN and CA\)"),
        ("alpha_deg,CL,CM,Cz\n0,0,0,0\n", "unknown column.*Cz"),
        ("alpha_deg,CL,CM,CN,CA\n0,0,0,0,0\n", "not both"),
        ("alpha_deg,CL,CM\n0,x,0\n", "line 2, column CL: 'x' is no number"),
        ("alpha_deg,CL,CM\n0,nan,0\n", "must be finite"),
        ("alpha_deg,CL,CM\n0,0,0\n0,1,0\n", "comes twice"),
        ("alpha_deg,CL,CM\n", "no measurement"),
        ("alpha_deg,CL,CM\n0,0,0\n9,1,0\n", "widen alpha_range"),
    ],
)
def test_bad_tunnel_files_are_refused(tmp_path, text, message):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        read_coefficients(path, Reference(S=1.0, c=1.0, b=1.0))


def test_bad_coefficients_are_refused():
    ref = Reference(S=1.0, c=1.0, b=1.0)
    with pytest.raises(ValueError, match=r"S must be > 0 \[m\^2\]"):
        Reference(S=0.0, c=1.0, b=1.0)
    with pytest.raises(ValueError, match="three finite"):
        Reference(S=1.0, c=1.0, b=1.0, point=(0.0, 0.0))
    with pytest.raises(ValueError, match="CL_delta needs one value"):
        AeroCoefficients(reference=ref, CL0=0, CM0=0, CL_alpha=1, CM_alpha=0, controls=("e",))
    with pytest.raises(ValueError, match="rates"):
        AeroCoefficients(reference=ref, CL0=0, CM0=0, CL_alpha=1, CM_alpha=0, rates="x")
    with pytest.raises(ValueError, match="ascend"):
        CoefficientTable(
            alpha=[0, 0],
            delta=[0],
            reynolds=[0],
            CL=np.zeros((1, 1, 2)),
            CD=np.zeros((1, 1, 2)),
            CM=np.zeros((1, 1, 2)),
        )
    with pytest.raises(ValueError, match="must have shape"):
        CoefficientTable(alpha=[0, 1], delta=[0], reynolds=[0], CL=np.zeros(2), CD=np.zeros(2), CM=np.zeros(2))
