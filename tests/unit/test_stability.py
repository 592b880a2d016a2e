"""Changes of stability on roots that are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aeroelastic.stability import NEUTRAL, boundaries, growth, unstable_counts

REFINED = 1e-9  # relative: docstring of `boundaries` (1e-12; splits 1e-9)


def pair(sigma, omega):
    """A conjugate pair, shape (n_V, 2)."""
    s = np.asarray(sigma) + 1j * np.broadcast_to(omega, np.shape(sigma))
    return np.stack([s, s.conj()], axis=1)


def search(values_at, mesh, scale=2.0):
    mesh = np.asarray(mesh, dtype=float)
    return boundaries(values_at, mesh, values_at(mesh), scale)


def summary(found):
    return [(b.kind, b.opens) for b in found], [b.V for b in found]


def test_counts_and_growth_leave_out_the_other_kind_and_nan():
    values = np.array([[1 + 2j, 1 - 2j, 0.5, -3.0, np.nan]])
    pairs, reals = unstable_counts(values, 1.0)
    assert (pairs[0], reals[0]) == (1, 1)
    assert growth(values, oscillatory=True)[0].tolist() == [1.0, *[-np.inf] * 4]
    assert growth(values, oscillatory=False)[0, :3].tolist() == [0.5, -3.0, -np.inf]


@pytest.mark.parametrize("width", [0.5, 0.05, 0.005])
def test_hump_and_dip_between_the_speeds_of_the_mesh(width):
    # sigma = +-((w/2)^2 - (V - 3.3)^2): unstable for a width w only, or stable for a width w only
    for sign, opens in ((1.0, True), (-1.0, False)):

        def values_at(V, sign=sign):
            return pair(sign * ((0.5 * width) ** 2 - (V - 3.3) ** 2), 2.0)

        kinds, speeds = summary(search(values_at, [1.0, 2.0, 3.0, 4.0, 5.0]))
        assert kinds == [("oscillatory", opens), ("oscillatory", not opens)]
        np.testing.assert_allclose(speeds, [3.3 - 0.5 * width, 3.3 + 0.5 * width], rtol=REFINED)


def test_no_boundary_where_a_hump_stays_below_zero():
    assert search(lambda V: pair(-1e-6 - (V - 3.3) ** 2, 2.0), [1.0, 2.0, 3.0, 4.0, 5.0]) == []


def test_real_root_and_its_frequency():
    found = search(lambda V: np.stack([0.5 * (V - 3.3), 0.0 * V - 2.0], axis=1) + 0j, [1.0, 5.0])
    kinds, speeds = summary(found)
    assert kinds == [("real", True)]
    assert speeds == pytest.approx([3.3], rel=REFINED)
    assert found[0].root == 0.0


def meeting(V, low, high, sign=1.0):
    """Unstable roots 1 +- sqrt(d) with d > 0 between `low` and `high` (sign 1), or outside (sign -1)."""
    root = np.sqrt(sign * (V - low) * (high - V) + 0j)
    return np.stack([1.0 + root, 1.0 - root], axis=1) * np.array([1.0, 1.0])


@pytest.mark.parametrize(("sign", "kinds"), [(1.0, ["split", "merge"]), (-1.0, ["merge", "split"])])
def test_pair_that_is_real_for_part_of_a_cell_only(sign, kinds):
    # counts agree at both ends of the cell: the meeting itself must be looked for
    found = search(lambda V: meeting(V, 3.2, 3.4, sign), [2.5, 3.0, 3.5, 4.0])
    assert [b.kind for b in found] == kinds
    np.testing.assert_allclose([b.V for b in found], [3.2, 3.4], rtol=REFINED)
    assert all(abs(b.root - 1.0) < 1e-3 for b in found)


def test_pair_that_only_comes_near_the_real_axis_stays_a_pair():
    assert search(lambda V: pair(0.0 * V + 1.0, 0.01 + (V - 3.3) ** 2), [2.5, 3.0, 3.5, 4.0]) == []


@pytest.mark.parametrize("noise", [1e-12, -1e-12])
def test_root_at_rest_at_zero_hides_no_crossing(noise):
    # steady flight on any path is a root at zero, up to rounding of either sign; a real root passes it at 3.3
    def values_at(V):
        rounding = noise * np.where(np.round(1e6 * V) % 2 == 0.0, 1.0, -1.0)
        return np.stack([rounding, 0.5 * (V - 3.3), 0.0 * V - 2.0], axis=1) + 0j

    kinds, speeds = summary(search(values_at, [1.0, 2.0, 4.0, 5.0]))
    assert kinds == [("real", True)]
    assert speeds == pytest.approx([3.3], rel=1e-8)  # NEUTRAL * scale / slope = 4e-9


def test_root_that_leaves_the_neutral_band_without_crossing_zero_is_no_less_unstable():
    # an undamped wing whose growth starts at zero with speed: unstable, however slowly at first
    kinds, speeds = summary(search(lambda V: pair(1e-10 * V**3, 2.0), [1.0, 2.0, 4.0, 5.0]))
    assert kinds == [("oscillatory", True)]
    assert speeds == pytest.approx([(2.0 * NEUTRAL / 1e-10) ** (1 / 3)], rel=1e-6)


def test_root_that_appears_already_unstable_crosses_nothing():
    # p-k and g have roots that come and go: an unstable one that appears is no flutter boundary
    def values_at(V):
        return np.where((V > 3.3)[:, None], pair(0.3 + 0.0 * V, 2.0), np.nan)

    assert search(values_at, [1.0, 2.0, 4.0, 5.0]) == []


def test_order_of_roots_does_not_matter():
    rng = np.random.default_rng(5)

    def values_at(V):
        values = np.hstack([pair(0.1 * (V - 3.3), 2.0), pair(0.2 * (4.1 - V), 5.0), (V - 4.47)[:, None] + 0j])
        return np.stack([row[rng.permutation(5)] for row in values]) if len(V) else values

    kinds, speeds = summary(search(values_at, np.linspace(1.0, 6.0, 6), 5.0))
    assert kinds == [("oscillatory", True), ("oscillatory", False), ("real", True)]
    np.testing.assert_allclose(speeds, [3.3, 4.1, 4.47], rtol=REFINED)


def test_shallow_crossing_is_refined_past_the_neutral_band():
    # growth leaves the band of NEUTRAL |s| = 4e-8 only 7e-5 after it crossed zero
    found = search(lambda V: pair(3e-2 * (1e-4 - (V - 3.3) ** 2), 40.0), np.linspace(3.0, 3.6, 7), 40.0)
    assert [b.opens for b in found] == [True, False]
    np.testing.assert_allclose([b.V for b in found], [3.29, 3.31], rtol=REFINED)


@pytest.mark.parametrize("gap", [1e-3, -1e-3])
def test_pair_and_its_real_roots_that_change_a_little_apart_are_one_split(gap):
    # p-k: the pair is last seen at 3.3 + gap, its two real roots first at 3.3
    def values_at(V):
        swinging = np.where(
            np.less(V, 3.3 + gap)[:, None], pair(1.0 + 0.0 * V, 0.01 + 3.4 - np.minimum(V, 3.4)), np.nan
        )
        real = np.where(np.greater(V, 3.3)[:, None], np.stack([1.0 + 0.1 * V, 1.0 - 0.1 * V], axis=1), np.nan)
        return np.hstack([swinging, real + 0j])

    found = search(values_at, [2.9, 3.1, 3.5, 3.6], 2.0)
    assert [b.kind for b in found] == ["split"]
    assert [b.V for b in found] == pytest.approx([3.3], abs=1.01e-3)
