"""Damping matrices: each mode gets its ratio, dampers act where they are, rigid-body modes are left alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import parse, read
from aeroservo.structure.damping import modal_damping, rayleigh_coefficients
from aeroservo.structure.modal import natural_modes

IDENTITY = 1e-12
PRESETS = Path(__file__).parents[2] / "src" / "aeroservo" / "aircraft" / "presets"


def with_damping(preset, table):
    return build(parse((PRESETS / f"{preset}.toml").read_text(encoding="utf-8") + "\n" + table, Path(preset)))


def ratios(model):
    """Damping ratios of the elastic modes from the eigenvalues in vacuum."""
    M, D, K = model.modes.M, model.modes.D, model.modes.K
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    roots = np.linalg.eigvals(A)
    roots = roots[roots.imag > 1e-6]
    return -(roots.real / np.abs(roots))[np.argsort(np.abs(roots))]


@pytest.mark.parametrize("preset", ["thesis-binary", "thesis-aircraft"])
def test_modal_ratios_are_those_of_the_elastic_modes(preset):
    model = with_damping(preset, "[damping.modal]\nratios = [0.05, 0.01]\n")
    np.testing.assert_allclose(ratios(model), [0.05, 0.01], rtol=1e-9)


def test_rayleigh_meets_both_ratios():
    structure = build(read("thesis-binary")).modes
    omega = natural_modes(structure).omega
    alpha, beta = rayleigh_coefficients((omega[0], omega[1]), (0.03, 0.02))
    model = with_damping("thesis-binary", f"[damping.rayleigh]\nalpha = {alpha}\nbeta = {beta}\n")
    np.testing.assert_allclose(ratios(model), [0.03, 0.02], rtol=1e-9)


def test_rayleigh_refuses_one_frequency():
    with pytest.raises(ValueError, match="two different frequencies"):
        rayleigh_coefficients((10.0, 10.0), (0.02, 0.02))


def test_dampers_act_on_the_elastic_coordinates():
    table = "[damping.viscous]\nplunge_N_s_per_m = 3.0\npitch_N_m_s = 0.5\n"
    np.testing.assert_allclose(with_damping("thesis-binary", table).modes.D, np.diag([3.0, 0.5]), atol=IDENTITY)
    np.testing.assert_allclose(with_damping("thesis-aircraft", table).modes.D, np.diag([3.0, 0.5, 0.0]), atol=IDENTITY)


def test_dampers_at_the_tip_of_a_beam():
    """Power of the dampers is that of the tip's own motion, whatever the modes."""
    model = with_damping("goland", "[damping.viscous]\nplunge_N_s_per_m = 3.0\npitch_N_m_s = 0.5\n")
    tip = int(np.argmax(model.modes.grid[:, 1]))
    rate = np.random.default_rng(0).standard_normal(model.modes.n)
    power = 3.0 * (model.modes.phi[tip, 2] @ rate) ** 2 + 0.5 * (model.modes.phi[tip, 4] @ rate) ** 2
    assert rate @ model.modes.D @ rate == pytest.approx(power, rel=IDENTITY)


def test_too_many_ratios_are_refused():
    with pytest.raises(ValueError, match="2 elastic modes"):
        modal_damping(build(read("thesis-aircraft")).modes, [0.1, 0.1, 0.1])
