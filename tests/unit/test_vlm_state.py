"""The lattice about a state: derivatives against differences, strip theory, and the far-field drag."""

import numpy as np
import pytest

from aeroservo.aero.coefficients import Reference
from aeroservo.aero.trefftz import induced_drag
from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
from aeroservo.aero.vlm_loads import lattice_derivatives, span_loading
from aeroservo.aero.vlm_normalwash import join_normalwash, rigid_normalwash, slope_normalwash
from aeroservo.aero.vlm_solve import solve_lattice
from aeroservo.aero.vlm_state import state_derivatives

DIFFERENCES = 1e-6  # a quadratic function's central difference is exact but for cancellation

OPTIONS = VortexLattice(chordwise=4, spanwise=14)


def solved(edge, chord, point=(0.3, 0.0, 0.0), options=OPTIONS, **flags):
    edge = np.asarray(edge, dtype=float)
    b = 2 * edge[-1, 1]
    ref = Reference(S=b * np.mean(chord), c=float(np.mean(chord)), b=b, point=point)
    grid = lattice([lattice_surface("w", edge, chord, options=options)], **({"full": True} | flags))
    wash = join_normalwash(
        [rigid_normalwash(grid, point), slope_normalwash(grid, "steady", -0.05 * np.ones(len(grid)))]
    )
    return solve_lattice(grid, wash), ref


def rates(ref, names):
    return np.array([{"p": 2 / ref.b, "q": 2 / ref.c, "r": 2 / ref.b}.get(n, 1.0) for n in names])


def test_derivatives_are_those_of_the_values():
    solution, ref = solved([[0, 0, 0], [0.9, 2, 0.25]], [1, 0.6])
    x = np.array([0.06, 0.03, 0.02, 0.015, -0.02, 0.8])
    d = state_derivatives(solution, ref, x)
    for i, scale in enumerate(rates(ref, d.names)):
        step = np.zeros(len(x))
        step[i] = 1e-3
        up, down = (state_derivatives(solution, ref, x + s * step).value for s in (1, -1))
        np.testing.assert_allclose(d.derivative[:, i], (up - down) / 2e-3 * scale, atol=DIFFERENCES, err_msg=d.names[i])


def test_at_rest_it_is_the_linear_lattice():
    """Without any lift the quadratic terms vanish: the derivatives are those of the linear loads."""
    solution, ref = solved([[0, 0, 0], [0.9, 2, 0.25]], [1, 0.6])
    d, linear = state_derivatives(solution, ref, np.zeros(6)), lattice_derivatives(solution, ref)
    for k, name, sign in ((1, "CY", 1), (2, "CL", -1), (3, "Cl", 1), (4, "CM", 1), (5, "Cn", 1)):
        np.testing.assert_allclose(d.derivative[k], sign * getattr(linear, name), atol=1e-12, err_msg=name)
    assert np.all(d.value == 0)


def test_near_field_drag_is_the_far_field_s():
    """On even panels: at once for a straight wing, and as the panels of a swept one get finer along the chord."""
    alpha = 0.05

    def gap(edge, chord, chordwise, spanwise):
        options = VortexLattice(chordwise=chordwise, spanwise=spanwise, spacing="uniform")
        solution, ref = solved(edge, chord, options=options)
        near = state_derivatives(solution, ref, [alpha, 0, 0, 0, 0, 0]).drag(alpha)
        return abs(near / (induced_drag(solution).matrix[0, 0] * alpha**2 / ref.S) - 1)

    assert gap([[0, 0, 0], [0, 3, 0]], [1, 1], 4, 16) < 0.004
    gaps = [gap([[0, 0, 0], [0.5245, 1, 0]], [0.7, 0.3], *n) for n in ((2, 16), (4, 16), (8, 16), (16, 16))]
    assert np.all(np.diff(gaps) < 0) and gaps[-1] < 0.015


def test_roll_due_to_yaw_rate_by_strips():
    """A long wing: 2 integral y^2 L' (body axes: half of it for lift by alpha, whose circulation yaw leaves alone)."""
    solution, ref = solved([[0, 0, 0], [0, 15, 0]], [1, 1], point=(0.25, 0, 0))
    loading = span_loading(solution)
    i = {n: k for k, n in enumerate(solution.names)}

    def by_strips(name, amount, share):
        load = loading.cl[:, i[name]] * amount * loading.chord * loading.width
        return share * np.sum(load * loading.y**2) * 2 / (ref.b**2 * ref.S) * 2

    x = np.zeros(6)
    x[i["alpha"]] = 0.1
    found = state_derivatives(solution, ref, x).derivative[3, i["r"]]
    assert found == pytest.approx(by_strips("alpha", 0.1, 0.5), rel=0.02)
    x = np.zeros(6)
    x[i["steady"]] = 1.0  # incidence of the wing itself: the circulation grows with the local speed too
    found = state_derivatives(solution, ref, x).derivative[3, i["r"]]
    strips = by_strips("steady", 1.0, 1.0)
    assert 0.75 * strips < found < strips  # the part that circulation adds feels the induced flow


def test_signs_of_lateral_derivatives_with_lift():
    swept, ref = solved([[0, 0, 0], [1.2, 2, 0]], [1, 0.6], point=(0.8, 0, 0))
    i = {n: k for k, n in enumerate(swept.names)}
    x = np.zeros(6)
    x[i["alpha"]] = 0.1
    d = state_derivatives(swept, ref, x).derivative
    assert d[3, i["beta"]] < 0  # sweep with lift acts as dihedral
    assert d[3, i["r"]] > 0  # the advancing wing lifts more
    assert d[5, i["p"]] < 0  # the falling wing's lift leans forward: adverse yaw
    forward, ref = solved([[1.2, 0, 0], [0, 2, 0]], [1, 0.6], point=(0.8, 0, 0))
    assert state_derivatives(forward, ref, x).derivative[3, i["beta"]] > 0
    higher = state_derivatives(swept, ref, 2 * x).derivative
    assert higher[3, i["beta"]] == pytest.approx(2 * d[3, i["beta"]], rel=1e-9)


def test_refusals():
    half, ref = solved([[0, 0, 0], [0, 2, 0]], [1, 1], full=False)
    with pytest.raises(ValueError, match="full=True"):
        state_derivatives(half, ref, np.zeros(6))
    solution, ref = solved([[0, 0, 0], [0, 2, 0]], [1, 1])
    with pytest.raises(ValueError, match="6 numbers"):
        state_derivatives(solution, ref, np.zeros(2))
    fast = solve_lattice(solution.lattice, solution.normalwash, mach=0.5)
    with pytest.raises(ValueError, match="incompressible"):
        state_derivatives(fast, ref, np.zeros(6))
