"""Section polars: lookups and their marks, wild points, the cache, XFOIL's files and its driver."""

import os
import shutil
import stat
import threading
from importlib.util import find_spec

import numpy as np
import pytest

from aeroservo.aero import polars_xfoil
from aeroservo.aero.airfoil_files import airfoil
from aeroservo.aero.polars import (
    INSIDE,
    OUTSIDE,
    STALLED,
    Polar,
    best_lift_to_drag,
    section_at_lift,
    section_coefficients,
)
from aeroservo.aero.polars_cache import cache_folder, cached_array, content_key
from aeroservo.aero.polars_neuralfoil import neuralfoil_polar
from aeroservo.aero.polars_points import polar_from_points, reject_wild_points, shipped_polar
from aeroservo.aero.polars_xfoil import Xfoil, parse_xfoil_polar, xfoil_points

LINEAR = 1e-12  # a table of a linear function is read exactly

XFOIL_TEXT = """
       XFOIL         Version 6.99

 Calculated polar for: MH 62  9.3%

 1 1 Reynolds number fixed          Mach number fixed

 xtrf =   1.000 (top)        1.000 (bottom)
 Mach =   0.100     Re =     1.500 e 6     Ncrit =   9.000  9.000

   alpha    CL        CD       CDp       CM     Top_Xtr  Bot_Xtr  Top_Itr  Bot_Itr
  ------ -------- --------- --------- -------- -------- -------- -------- --------
   1.000   0.2253   0.00462   0.00009  -0.0110   0.5783   0.9841  32.1639 158.3966
   0.000   0.0830   0.00498   0.00003  -0.0051   0.6376   0.7446  27.8646 141.1763
  -0.500   0.0303   0.00536   0.00002  -0.0060   0.6601   0.6170  26.0000 130.0000
   0.000   0.0831   0.00499   0.00003  -0.0052   0.6376   0.7446  27.8646 141.1763
"""


def straight(stall_deg=10.0):
    """CL = 5 alpha + 3 delta up to a stall, CD and CM linear in log Re, alpha and delta."""
    alpha, delta, reynolds = np.radians(np.arange(-12, 16.0)), np.radians([-10.0, 0.0, 10.0]), np.array([1e6, 2e6, 4e6])
    r, d, a = np.meshgrid(np.log(reynolds), delta, alpha, indexing="ij")
    stall = np.radians(stall_deg)
    CL = 5 * np.where(a > stall, 2 * stall - a, a) + 3 * d
    return Polar(
        name="t",
        source="formula",
        alpha=alpha,
        delta=delta,
        reynolds=reynolds,
        CL=CL,
        CD=0.1 - 0.005 * r + 0 * a,
        CM=0.1 * a - 0.6 * d,
    )


def test_lookup_is_linear_and_exact():
    rng = np.random.default_rng(0)
    a, d, re = np.radians(rng.uniform(-12, 9, 50)), np.radians(rng.uniform(-10, 10, 50)), rng.uniform(1e6, 4e6, 50)
    p = section_coefficients(straight(), a, reynolds=re, delta=d)
    np.testing.assert_allclose(p.CL, 5 * a + 3 * d, atol=LINEAR)
    np.testing.assert_allclose(p.CD, 0.1 - 0.005 * np.log(re), atol=LINEAR)
    np.testing.assert_allclose(p.CM, 0.1 * a - 0.6 * d, atol=LINEAR)
    assert np.all(p.mark == INSIDE)
    q = section_at_lift(straight(), p.CL, reynolds=re, delta=d)
    np.testing.assert_allclose(q.alpha, a, atol=1e-10)
    np.testing.assert_allclose(q.CD, p.CD, atol=1e-10)


def test_nothing_is_extrapolated_silently():
    polar = straight()
    p = section_coefficients(polar, np.radians([0.0, 12.0, 20.0, -13.0]), reynolds=1e6)
    assert p.mark.tolist() == [INSIDE, STALLED, OUTSIDE, OUTSIDE]
    assert np.isnan(p.CL[2]) and np.isfinite(p.CL[1])
    for options in ({"reynolds": 0.9e6}, {"reynolds": 5e6}, {"reynolds": 1e6, "delta": np.radians(11.0)}):
        p = section_coefficients(polar, 0.0, **options)
        assert p.mark == OUTSIDE and np.isnan(p.CD)
        q = section_at_lift(polar, 0.1, **options)
        assert q.mark == OUTSIDE and np.isnan(q.CD)
    top = 5 * np.radians(10.0)
    q = section_at_lift(polar, np.array([top + 0.1, -2.0]), reynolds=1e6)
    assert q.mark.tolist() == [STALLED, OUTSIDE]  # below: the table ends while lift still falls
    assert q.CL[0] == pytest.approx(top) and np.isnan(q.CL[1])


def test_missing_points_stay_missing():
    rows = [(1e6, 0.0, np.radians(a), 0.1 * a, 0.01, 0.0) for a in (-2, -1, 0, 1, 5, 6)]
    polar = polar_from_points("gaps", "test", rows)
    p = section_coefficients(polar, np.radians([0.25, 3.0, 5.5]), reynolds=1e6)
    assert p.mark.tolist() == [INSIDE, OUTSIDE, INSIDE]
    np.testing.assert_allclose(p.CL[[0, 2]], [0.025, 0.55], atol=1e-9)
    with pytest.raises(ValueError, match="no converged point"):
        polar_from_points("none", "test", np.zeros((0, 6)))


def test_bad_tables_are_refused():
    good = straight()
    fields = {k: getattr(good, k) for k in ("alpha", "delta", "reynolds", "CL", "CD", "CM")}
    with pytest.raises(ValueError, match="ascend"):
        Polar(name="x", source="", **fields | {"alpha": good.alpha[::-1]})
    with pytest.raises(ValueError, match="shape"):
        Polar(name="x", source="", **fields | {"CL": good.CL[0]})
    with pytest.raises(ValueError, match="reynolds"):
        Polar(name="x", source="", **fields | {"reynolds": np.array([-1.0, 1.0, 2.0])})
    with pytest.raises(ValueError, match=r"must lie in the table.*1e\+06 to 4e\+06"):
        best_lift_to_drag(good, reynolds=1e5)
    with pytest.raises(ValueError, match="no shipped polar"):
        shipped_polar("clark y", "hinged")


def test_one_wild_point_does_not_win():
    polar = straight()
    CD = np.array(polar.CD)
    CD[0, 1, 14] = 1e-4
    wild = Polar(
        name="w",
        source="",
        alpha=polar.alpha,
        delta=polar.delta,
        reynolds=polar.reynolds,
        CL=polar.CL,
        CD=CD,
        CM=polar.CM,
    )
    assert best_lift_to_drag(wild, reynolds=1e6)[0] == pytest.approx(
        best_lift_to_drag(polar, reynolds=1e6)[0], rel=0.01
    )


def test_wild_points_go_and_honest_ones_stay():
    alpha = np.radians(np.arange(-5, 12, 0.5))
    CL = np.minimum(6 * alpha, 1.0 - 2 * np.maximum(alpha - 0.17, 0))
    CD = 0.006 + 0.02 * alpha**2 + 0.1 * np.maximum(alpha - 0.16, 0)
    rows = np.stack([alpha, CL, CD, 0 * alpha], axis=-1)
    np.testing.assert_array_equal(reject_wild_points(rows), rows)  # a stall is no wild point
    bad = rows.copy()
    bad[7, 1] += 0.3
    bad[20, 2] *= 0.1
    kept = reject_wild_points(bad)
    assert len(kept) == len(rows) - 2
    assert not np.any(np.isin(alpha[[7, 20]], kept[:, 0]))


def test_xfoil_file():
    p = parse_xfoil_polar(XFOIL_TEXT)
    assert (p.name, p.reynolds, p.mach, p.n_crit) == ("MH 62  9.3%", 1.5e6, 0.1, 9.0)
    np.testing.assert_allclose(np.degrees(p.alpha), [-0.5, 0.0, 1.0])
    assert p.CL[1] == 0.0831  # of a repeated angle the last one
    assert p.transition_top[2] == 0.5783
    xflr5 = XFOIL_TEXT.replace("Calculated polar for", "xflr5 v6\n Calculated polar for").replace(
        "  Top_Itr  Bot_Itr", ""
    )
    np.testing.assert_allclose(parse_xfoil_polar(xflr5).CM, p.CM)
    with pytest.raises(ValueError, match="no XFOIL polar file"):
        parse_xfoil_polar("something else")
    with pytest.raises(ValueError, match="no angle converged"):
        parse_xfoil_polar(XFOIL_TEXT.split("   1.000   0.2253")[0])
    with pytest.raises(ValueError, match="Reynolds"):
        parse_xfoil_polar(XFOIL_TEXT.replace("Re =", "xx ="))


def fake_xfoil(folder, body):
    path = folder / "xfoil-fake"
    path.write_text("#!/bin/sh\n" + body)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


@pytest.mark.skipif(os.name != "posix", reason="a shell script stands in for XFOIL")
def test_driver_explains_what_is_wrong(tmp_path, monkeypatch):
    foil = airfoil("naca0012")
    with pytest.raises(ValueError, match=r"not installed.*apt-get"):
        xfoil_points(foil, 1e6, options=Xfoil(executable="no-such-xfoil"), cache=False)
    trapped = fake_xfoil(tmp_path, "kill -FPE $$\n")
    monkeypatch.setattr(polars_xfoil, "_untrapped", lambda folder: None)
    with pytest.raises(ValueError, match=r"SIGFPE.*Debian"):
        xfoil_points(foil, 1e6, options=Xfoil(executable=trapped), cache=False)
    for body in ("sleep 60\n", "while :; do echo ' x: NaN'; done\n", "exit 0\n"):
        program = fake_xfoil(tmp_path, body)
        points = xfoil_points(foil, 1e6, options=Xfoil(executable=program, seconds=1.0), cache=False)
        assert points.shape == (0, 4)  # nothing converged, and no hang
    program = fake_xfoil(tmp_path, "sleep 60\n")
    xfoil_points(foil, 1e6, options=Xfoil(executable=program, seconds=0.3), folder=tmp_path / "cache")
    assert not list((tmp_path / "cache").glob("*"))  # a run cut short is not remembered as the answer
    with pytest.raises(ValueError, match="reynolds must be > 0"):
        xfoil_points(foil, -1.0)
    with pytest.raises(ValueError, match="hold zero"):
        Xfoil(alpha_from=0.1)
    with pytest.raises(ValueError, match="must be positive"):
        Xfoil(seconds=0.0)


@pytest.mark.skipif(
    shutil.which("xfoil") is None or shutil.which("cc") is None, reason="no xfoil or no C compiler here"
)
def test_installed_xfoil_gives_the_stored_figures(tmp_path):
    options = Xfoil(alpha_from=-0.018, alpha_to=0.036, alpha_step=float(np.radians(1.0)), seconds=40.0)
    points = xfoil_points(airfoil("mh62"), 1e6, options=options, folder=tmp_path)
    stored = {
        -1: (-0.0242, 0.00570, -0.0064),
        0: (0.0830, 0.00498, -0.0051),
        1: (0.2253, 0.00462, -0.0110),
        2: (0.3554, 0.00505, -0.0151),
    }
    found = {round(np.degrees(row[0])): row[1:] for row in points}
    for angle, values in stored.items():  # XFOIL 6.99: the path to a point leaves traces in the last digits
        assert np.all(np.abs(found[angle] - values) < [2e-3, 5e-5, 5e-4])
    assert len(list(tmp_path.glob("*.npy"))) == 1


def test_cache_is_keyed_by_content_and_atomic(tmp_path, monkeypatch):
    calls = []

    def compute():
        calls.append(1)
        return np.arange(5.0)

    parts = ["x", 1.0, np.eye(2)]
    for _ in range(3):
        np.testing.assert_array_equal(cached_array(parts, compute, folder=tmp_path), np.arange(5.0))
    assert len(calls) == 1
    cached_array(["x", 1.0, 2 * np.eye(2)], compute, folder=tmp_path)
    cached_array(["x", 1, np.eye(2)], compute, folder=tmp_path)  # an integer is another input
    assert len(calls) == 3 and content_key(["ab"]) != content_key(["a", "b"])
    whole = tmp_path / f"{content_key(parts)}.npy"
    whole.write_bytes(whole.read_bytes()[:40])  # half a file, as after a crash: computed anew
    np.testing.assert_array_equal(cached_array(parts, compute, folder=tmp_path), np.arange(5.0))
    assert len(calls) == 4 and not list(tmp_path.glob("*.part"))
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert cached_array(parts, compute, folder=blocked / "below").shape == (5,)  # no place to keep it
    monkeypatch.setenv("AEROSERVO_CACHE", str(tmp_path / "here"))
    assert cache_folder() == tmp_path / "here"
    monkeypatch.delenv("AEROSERVO_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "aeroservo"


def test_cache_under_many_writers(tmp_path):
    value = np.random.default_rng(0).random(20_000)
    results = []
    threads = [
        threading.Thread(target=lambda: results.append(cached_array(["big"], lambda: value, folder=tmp_path)))
        for _ in range(12)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(r, value) for r in results) and len(results) == 12


@pytest.mark.skipif(find_spec("neuralfoil") is not None, reason="NeuralFoil is here")
def test_without_neuralfoil_the_message_says_what_to_install():
    with pytest.raises(ValueError, match=r"pip install aeroservo\[airfoil\]"):
        neuralfoil_polar(airfoil("mh62"), alpha=[0.0], delta=[0.0], reynolds=[1e6])
