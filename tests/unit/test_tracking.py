"""Following roots whose paths are known."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aeroelastic.branches import Branches, unstable_intervals
from aeroservo.aeroelastic.stability import Boundary
from aeroservo.aeroelastic.tracking import follow, resolved_mesh, steps_between


def shuffled(rows, seed):
    """The same roots at each speed in any order."""
    rng = np.random.default_rng(seed)
    return np.stack([row[rng.permutation(len(row))] for row in np.asarray(rows, dtype=complex)])


def followed(values):
    return np.take_along_axis(values, follow(values, steps_between(values)[0]), axis=1)


@pytest.mark.parametrize("seed", range(5))
def test_crossing_frequencies_are_followed_through(seed):
    V = np.linspace(0.0, 1.0, 41)
    rows = np.stack([1j * (1 + V) - 0.1, -1j * (1 + V) - 0.1, 1j * (2.1 - V) - 0.4, -1j * (2.1 - V) - 0.4], axis=1)
    branches = followed(shuffled(rows, seed))
    for branch in branches.T:
        slope = np.diff(branch.imag) / np.diff(V)
        assert np.allclose(slope, slope[0])


@pytest.mark.parametrize("seed", range(5))
def test_pair_that_meets_on_the_real_axis_keeps_order_on_both_sides(seed):
    # 1 +- sqrt((V - 1)(2 - V)): real between 1 and 2, among real roots that scale with speed as lags do
    V = np.linspace(0.5, 2.5, 82)
    root = np.sqrt((V - 1.0) * (2.0 - V) + 0j)
    rows = np.stack([1.0 + root, 1.0 - root, -V, -3.0 * V, 4j + 0 * V, -4j + 0 * V], axis=1)
    branches = followed(shuffled(rows, seed))
    upper = branches[:, np.argmin(np.abs(branches[0] - (1.0 + root[0])))]
    real = (V > 1.0) & (V < 2.0)
    np.testing.assert_allclose(upper[real], 1.0 + root[real], rtol=1e-12)
    np.testing.assert_allclose(upper[V > 2.0], 1.0 + 1j * np.abs(root[V > 2.0]), rtol=1e-12)
    for j in np.flatnonzero(branches[0].imag == 0.0):
        np.testing.assert_allclose(np.diff(branches[:, j]) / np.diff(V), np.diff(branches[:, j])[0] / np.diff(V)[0])


def test_every_step_is_a_permutation_of_random_roots():
    rng = np.random.default_rng(3)
    for _ in range(200):
        rows = []
        for _ in range(2):
            pairs = int(rng.integers(0, 4))
            s = rng.normal(size=pairs) + 1j * rng.uniform(0.01, 3.0, pairs)
            rows.append(rng.permutation(np.concatenate([s, s.conj(), rng.normal(size=6 - 2 * pairs)])))
        step = steps_between(np.array(rows))[0][0]
        assert sorted(step) == list(range(6))
        if np.sum(rows[0].imag > 0) == np.sum(rows[1].imag > 0):
            assert np.array_equal(np.sign(rows[0].imag), np.sign(rows[1][step].imag))


def test_missing_roots_are_matched_with_missing_roots():
    values = np.array([[1j, -1j, np.nan, -2.0], [-2.1, np.nan, -1.1j, 1.1j]])
    step = steps_between(values)[0]
    assert step.tolist() == [[3, 2, 1, 0]]


def test_roots_without_conjugates_are_followed_too():
    # the k method's: one root a mode, nan where there is none
    rng = np.random.default_rng(4)
    for _ in range(50):
        values = rng.normal(size=(2, 4)) + 1j * rng.uniform(0.1, 3.0, (2, 4))
        values[0, rng.integers(4)] = np.nan
        assert sorted(steps_between(values)[0][0]) == [0, 1, 2, 3]


def test_mesh_is_refined_until_roots_that_pass_closely_are_told_apart():
    def values_at(V):  # avoided crossing at V = 0.53, frequencies 0.002 apart
        half = np.sqrt((V - 0.53) ** 2 + 1e-6)
        return np.stack([1j * (5 + half), 1j * (5 - half), -1j * (5 + half), -1j * (5 - half)], axis=1)

    V = np.linspace(0.0, 1.0, 5)
    mesh, values, steps = resolved_mesh(values_at, V, values_at(V))
    assert set(V) <= set(mesh)
    branches = np.take_along_axis(values, follow(values, steps), axis=1)
    assert np.all(np.abs(branches[:, 0] - values_at(mesh)[:, 0]) < 1e-12)  # it veers and does not cross
    assert np.array_equal(steps, steps_between(values)[0])


# --- intervals from changes -------------------------------------------------------------------------------------------


def branches_of(*columns, names):
    V = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    roots = np.stack([np.broadcast_to(c, V.shape) for c in columns], axis=1).astype(complex)
    return Branches(V=V, roots=roots, names=names, primary=roots[0].imag >= 0.0)


def test_two_divergences_that_become_one_oscillation_both_close():
    still = branches_of(-1.0 + 0j, -2.0 + 0j, names=("heave", "lag 1"))
    changes = [
        Boundary(V=2.0, kind="real", opens=True, root=0j),
        Boundary(V=3.0, kind="real", opens=True, root=0j),
        Boundary(V=4.0, kind="merge", opens=True, root=0.5 + 0j),
    ]
    found = unstable_intervals(changes, still, 1.0, 1.0)
    assert [(i.start, i.end, i.kind) for i in found] == [
        (2.0, 4.0, "divergence"),
        (3.0, 4.0, "divergence"),
        (4.0, None, "flutter"),
    ]


def test_interval_after_a_split_holds_two_roots_and_closes_with_the_second():
    still = branches_of(-1.0 + 1j, -1.0 - 1j, names=("pitch", "pitch"))
    changes = [
        Boundary(V=2.0, kind="oscillatory", opens=True, root=1j),
        Boundary(V=3.0, kind="split", opens=True, root=1.0 + 0j),
        Boundary(V=4.0, kind="real", opens=False, root=0j),
    ]
    found = unstable_intervals(changes, still, 1.0, 1.0)
    assert [(i.start, i.end, i.kind) for i in found] == [(2.0, 3.0, "flutter"), (3.0, None, "divergence")]
    changes.append(Boundary(V=4.5, kind="real", opens=False, root=0j))
    assert unstable_intervals(changes, still, 1.0, 1.0)[1].end == 4.5


def test_pair_of_a_mode_and_a_lag_has_the_name_of_the_mode():
    shared = branches_of(0.5 + 2j, 0.5 - 2j, names=("lag 1", "heave"))
    assert shared.name_at(3.0, 0.5 + 2j) == "heave"
    met = branches_of(0.5 + 0j, 0.5 + 1e-6, -3.0, names=("lag 1", "heave", "pitch"))
    assert met.name_at(3.0, 0.5 + 0j, meeting=True) == "heave"
    assert met.name_at(3.0, 0.5 + 0j) == "lag 1"


def test_real_root_that_passes_one_at_rest_has_the_name_of_the_one_that_is_unstable_beside():
    # real roots keep their order, so the one at rest goes on as the unstable one, and the other stays at zero
    V = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    roots = np.stack([[0.0, 0.0, 1e-12, 1.0, 2.0], [-2.0, -1.0, 0.0, 1e-12, 0.0], np.full(5, -9.0)], axis=1)
    passing = Branches(V=V, roots=roots + 0j, names=("heave", "bending 1", "pitch"), primary=np.ones(3, dtype=bool))
    assert passing.name_at(3.0, 0j) == "heave"
