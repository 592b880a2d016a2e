"""Airfoils: files of every kind, NACA formulas, thin-airfoil theory by two routes, deflected outlines."""

import json
from importlib.resources import files

import numpy as np
import pytest

from aeroservo.aero.airfoil import Airfoil, mean_line, repanel, surfaces, thickness
from aeroservo.aero.airfoil_deflect import hinged_outline, morphed_outline
from aeroservo.aero.airfoil_files import airfoil, parse_airfoil, read_airfoil, shipped_airfoils
from aeroservo.aero.airfoil_naca import naca_camber, naca_outline
from aeroservo.aero.airfoil_thin import camber_coefficients, hinged_derivatives, morphed_derivatives

REFERENCE = json.loads((files("aeroservo") / "cases" / "thesis_wing" / "reference.json").read_text(encoding="utf-8"))[
    "section_control_derivatives_Re1e6_per_rad"
]

QUADRATURE = 1e-6  # integrals by midpoint sums
PRINTED = 2e-3  # reference figures have three digits

MH62 = (files("aeroservo.aero") / "airfoils" / "mh62.dat").read_text(encoding="utf-8")
SPARSE = "1 0\n.8 .03\n.5 .06\n.2 .05\n0 0\n.2 -.03\n.5 -.03\n.8 -.01\n1 0\n"
UPPER = "0 0\n.2 .05\n.5 .06\n.8 .03\n1 0\n"
LOWER = "0 0\n.2 -.03\n.5 -.03\n.8 -.01\n1 0\n"


def outline(text):
    return parse_airfoil(text).points


@pytest.mark.parametrize(
    "text",
    [
        "sparse\n" + SPARSE,
        SPARSE,
        "# comment\nname with 2 numbers\n" + SPARSE.replace(" ", ", "),
        "semicolons\n" + SPARSE.replace(" ", ";"),
        "tabs\r\n" + SPARSE.replace(" ", "\t").replace("\n", "\r\n"),
        "lednicer\n5. 5.\n\n" + UPPER + "\n" + LOWER,
        "lednicer without counts\n" + UPPER + "\n" + LOWER,
        "backwards\n" + "\n".join(SPARSE.strip().splitlines()[::-1]),
        "per cent\n" + "\n".join(" ".join(str(100 * float(v)) for v in line.split()) for line in SPARSE.splitlines()),
        "doubled points\n" + SPARSE.replace(".5 .06\n", ".5 .06\n.5 .06\n"),
        "\ufeffbyte order mark\n" + SPARSE,
    ],
)
def test_every_kind_of_file_gives_the_same_outline(text):
    np.testing.assert_allclose(outline(text), outline("plain\n" + SPARSE), atol=1e-12)


def test_blunt_and_crossing_trailing_edges_are_kept():
    blunt = "blunt\n1 .002\n.8 .03\n.5 .06\n.2 .05\n0 0\n.2 -.03\n.5 -.03\n.8 -.01\n1 -.002\n"
    points = outline(blunt)
    np.testing.assert_allclose(points[[0, -1], 1], [0.002, -0.002])
    foil = airfoil("MH-62")
    upper, lower = surfaces(foil, np.array([0.99]))
    assert abs(upper[0] - lower[0]) < 2e-3  # reflexed: the surfaces all but touch, and the file is taken as it is
    assert foil.name == "MH 62  9.3%"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("three\n1 0\n0 0\n1 0\n", "3 point"),
        ("nothing\n", "0 point"),
        ("", "0 point"),
        ("nan\n" + SPARSE.replace(".06", "nan"), "line 4 holds a value that is not finite"),
        ("inf\n" + SPARSE.replace(".06", "inf"), "not finite"),
        ("words\n" + SPARSE.replace(".5 .06", ".5 oops"), "line 4 is no point"),
        ("shuffled\n1 0\n.2 .05\n.8 .03\n0 0\n.5 .06\n.2 -.03\n.8 -.01\n.5 -.03\n1 0\n", "once round"),
        ("one side\n" + UPPER + ".9 0\n.95 0\n", "once round"),
        ("vertical\n" + "\n".join(f"0.5 {0.1 * i}" for i in range(9)), "all points lie at x"),
        ("open\n.6 .05\n.5 .06\n.2 .05\n0 0\n.2 -.03\n.5 -.03\n.8 -.01\n1 0\n", "short of the trailing edge"),
    ],
)
def test_bad_files_are_refused(text, message):
    with pytest.raises(ValueError, match=message):
        parse_airfoil(text)


def test_reading_from_disk(tmp_path):
    path = tmp_path / "my foil.dat"
    path.write_text(SPARSE)
    assert read_airfoil(path).name == "my foil"
    assert airfoil(str(path)).name == "my foil"
    with pytest.raises(ValueError, match="cannot be read"):
        read_airfoil(tmp_path / "absent.dat")
    with pytest.raises(ValueError, match=r"no airfoil 'clark'.*mh62"):
        airfoil("clark")
    assert "mh62" in shipped_airfoils()
    with pytest.raises(ValueError, match="7 or more"):
        Airfoil(name="few", points=np.zeros((3, 2)))


def test_mh62_is_the_published_foil():
    t, x = thickness(airfoil("mh62"))
    assert t == pytest.approx(0.093, abs=2e-4)  # its name says 9.3 %
    assert 0.2 < x < 0.35
    points = airfoil("mh62").points
    stored = np.array([[float(v) for v in line.split()] for line in MH62.splitlines()[1:]])
    scale = stored[:, 0].max() - stored[:, 0].min()
    np.testing.assert_allclose(points, (stored - [stored[:, 0].min(), 0]) / scale, atol=1e-12)


@pytest.mark.parametrize("n", [40, 160, 300])
def test_repanelling_keeps_the_shape(n):
    foil = airfoil("naca2412")
    coarse = repanel(foil, n)
    assert len(coarse.points) == n + 1
    np.testing.assert_allclose(coarse.points[[0, -1]], foil.points[[0, -1]], atol=1e-12)
    x = np.linspace(0.02, 0.98, 50)
    for a, b in zip(surfaces(coarse, x), surfaces(foil, x)):
        np.testing.assert_allclose(a, b, atol=3e-4 if n == 40 else 2e-5)
    with pytest.raises(ValueError, match="even"):
        repanel(foil, 31)


def test_naca_ordinates():
    """Printed ordinates of NACA 2412 (Abbott & von Doenhoff, appendix III), in per cent of the chord."""
    upper, lower = surfaces(airfoil("naca2412"), np.array([0.05, 0.3, 0.7]))
    np.testing.assert_allclose(100 * upper, [4.13, 7.88, 5.18], atol=0.06)
    np.testing.assert_allclose(100 * lower, [-3.01, -4.12, -2.06], atol=0.09)
    assert thickness(airfoil("naca0012"))[0] == pytest.approx(0.12, abs=1e-4)


def test_naca_mean_lines():
    x = np.linspace(0, 1, 2001)
    for digits in ("2412", "4415", "23012", "25112", "24115"):
        z, slope = naca_camber(digits, x)
        np.testing.assert_allclose(np.gradient(z, x)[2:-2], slope[2:-2], atol=3e-3)
        np.testing.assert_allclose(z[[0, -1]], 0, atol=5e-5)
    # the 230 line's design lift of 0.3 without a peak at the nose: theory's zero-lift angle and moment
    alpha, moment = camber_coefficients(airfoil("naca23012"))
    assert np.degrees(alpha) == pytest.approx(-1.09, abs=0.02)
    assert moment == pytest.approx(-0.0127, abs=3e-4)
    # reflexed lines are made for no moment
    assert camber_coefficients(airfoil("naca23112"))[1] == pytest.approx(0.0, abs=1.5e-3)
    for bad in ("2012", "26012", "123", "2400"):
        with pytest.raises(ValueError, match="NACA"):
            naca_outline(bad) if bad == "2400" else naca_camber("2012".replace("1", "0") if bad == "2012" else bad, x)


@pytest.mark.parametrize("hinge", [0.2, 0.5, 0.75, 0.9])
def test_thin_airfoil_controls_against_quadrature(hinge):
    t = (np.arange(400_000) + 0.5) * np.pi / 400_000
    x = (1 - np.cos(t)) / 2
    shapes = {
        "hinged": (np.where(x > hinge, -1.0, 0.0), hinged_derivatives(hinge)),
        "same_drop": (-2 * np.maximum(x - hinge, 0) / (1 - hinge), morphed_derivatives(hinge)),
        "same_slope": (-np.maximum(x - hinge, 0) / (1 - hinge), morphed_derivatives(hinge, reading="same_slope")),
    }
    for slope, (cl, cm) in shapes.values():
        a0, a1, a2 = (np.mean(slope * np.cos(n * t)) for n in range(3))
        assert cl == pytest.approx(2 * np.pi * (-a0 + a1), rel=1e-4)
        assert cm == pytest.approx(np.pi / 2 * (a2 - a1), rel=1e-4)
    with pytest.raises(ValueError, match=r"\[0, 1\)"):
        hinged_derivatives(1.0)
    with pytest.raises(ValueError, match="reading"):
        morphed_derivatives(0.5, reading="equal")


def test_thin_airfoil_figures():
    np.testing.assert_allclose(hinged_derivatives(0.75), REFERENCE["hinge_0.75"]["thin_airfoil"], rtol=PRINTED)
    np.testing.assert_allclose(
        morphed_derivatives(0.75), REFERENCE["smooth_same_trailing_edge_drop"]["thin_airfoil"], rtol=PRINTED
    )
    np.testing.assert_allclose(hinged_derivatives(0.0), [2 * np.pi, 0.0], atol=1e-12)  # all of it moves: an angle


def test_camber_by_heights_agrees_with_slopes():
    t = (np.arange(200_000) + 0.5) * np.pi / 200_000
    _, slope = naca_camber("4412", (1 - np.cos(t)) / 2)
    alpha, moment = camber_coefficients(airfoil("naca4412"))
    assert alpha == pytest.approx(np.mean(slope * (1 - np.cos(t))), abs=1e-5)
    assert moment == pytest.approx(np.pi / 2 * np.mean(slope * (np.cos(2 * t) - np.cos(t))), abs=1e-5)


@pytest.mark.parametrize("delta_deg", [-15.0, -3.0, 3.0, 15.0])
@pytest.mark.parametrize("name", ["mh62", "naca0012", "naca4415"])
def test_hinged_outline_is_a_turned_flap(name, delta_deg):
    foil, delta = airfoil(name), np.radians(delta_deg)
    bent = hinged_outline(foil, 0.75, delta)
    upper, lower = surfaces(foil, np.array(0.75))
    pivot = np.array([0.75, (upper + lower) / 2])
    arm = foil.points[0] - pivot
    turn = np.array([[np.cos(delta), np.sin(delta)], [-np.sin(delta), np.cos(delta)]])
    expected = pivot + turn @ arm
    np.testing.assert_allclose(bent.points[0], expected, atol=1e-9)
    assert np.sign(bent.points[0, 1] - foil.points[0, 1]) == -np.sign(delta)
    # ahead of the hinge nothing moves, and the outline does not cross itself before the last 2 % of the chord
    x = np.linspace(0.05, 0.7, 30)
    np.testing.assert_allclose(surfaces(bent, x), surfaces(foil, x), atol=2e-4)
    p = bent.points[(bent.points[:, 0] < 0.975)]
    assert not crosses_itself(p)
    # nowhere does it turn back: the sharpest corner is the flap's own
    nose = int(np.argmin(p[:, 0]))
    for side in (p[: nose + 1], p[nose:]):
        steps = np.diff(side[side[:, 0] > 0.1], axis=0)
        turns = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
        assert turns.max() < abs(delta) + np.radians(3.0)


def crosses_itself(p):
    a, b = p[:-1], p[1:]

    def side(u, v, w):
        return np.sign(
            (v[..., 0] - u[..., 0]) * (w[..., 1] - u[..., 1]) - (v[..., 1] - u[..., 1]) * (w[..., 0] - u[..., 0])
        )

    i, j = np.triu_indices(len(a), 2)
    return bool(
        np.any(
            (side(a[i], b[i], a[j]) * side(a[i], b[i], b[j]) < 0)
            & (side(a[j], b[j], a[i]) * side(a[j], b[j], b[i]) < 0)
        )
    )


@pytest.mark.parametrize("reading", ["same_drop", "same_slope"])
def test_morphed_outline_has_the_stated_camber(reading):
    foil, delta, hinge = airfoil("naca0012"), np.radians(8.0), 0.75
    bent = morphed_outline(foil, hinge, delta, reading=reading)
    x = np.array([0.5, 0.8, 0.9, 1.0])
    upper, lower = surfaces(bent, x)
    s = 1.0 if reading == "same_drop" else 0.5
    expected = -np.tan(delta) * s * np.maximum(x - hinge, 0) ** 2 / (1 - hinge)
    np.testing.assert_allclose((upper + lower) / 2, expected, atol=2e-5)
    z, slope = mean_line(bent, np.array([0.9]))
    assert z[0] == pytest.approx(expected[2], abs=2e-5)
    assert slope[0] == pytest.approx(-2 * s * np.tan(delta) * 0.15 / 0.25, abs=3e-3)
    hinged = hinged_outline(foil, hinge, delta).points[0, 1]
    if reading == "same_drop":
        assert bent.points[0, 1] == pytest.approx(hinged, rel=0.02)  # the hinged one turns: sin, not tan


def test_bad_deflections_are_refused():
    foil = airfoil("mh62")
    with pytest.raises(ValueError, match="hinge must lie"):
        hinged_outline(foil, 0.99, 0.1)
    with pytest.raises(ValueError, match=r"\+-40 deg"):
        morphed_outline(foil, 0.75, 1.0)
    with pytest.raises(ValueError, match="height"):
        hinged_outline(foil, 0.75, 0.1, height=2.0)
    with pytest.raises(ValueError, match="reading"):
        morphed_outline(foil, 0.75, 0.1, reading="x")
    assert hinged_outline(foil, 0.75, 0.0).points.shape == (201, 2)
