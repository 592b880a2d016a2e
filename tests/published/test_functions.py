"""Every number of the published-functions case, read from the package's own case folder."""

import json
from importlib.resources import files

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from aeroservo.aero.indicial import (
    KUSSNER_LEISHMAN,
    KUSSNER_SEARS_SPARKS,
    WAGNER_R_T_JONES,
    WAGNER_W_P_JONES,
    garrick_wagner,
    kussner_function,
    rational_kussner,
    sears_function,
    wagner_function,
)
from aeroservo.aero.theodorsen import theodorsen_function

EXACT = 1e-10  # absolute, on values of order one: the project's requirement
GRID = 3e-7  # absolute: how far the reference's search grid in k may miss the true maximum

REFERENCE = json.loads((files("aeroservo") / "cases" / "functions" / "reference.json").read_text(encoding="utf-8"))


def column(table, name):
    return np.array([row[name] for row in REFERENCE[table]])


def test_theodorsen():
    C = theodorsen_function(column("theodorsen_sears", "k"))
    np.testing.assert_allclose(C.real, column("theodorsen_sears", "F"), rtol=0, atol=EXACT)
    np.testing.assert_allclose(C.imag, column("theodorsen_sears", "G"), rtol=0, atol=EXACT)
    assert C.size == 32


@pytest.mark.parametrize(("reference", "name"), [("midchord", "S"), ("leading_edge", "SLE")])
def test_sears(reference, name):
    S = sears_function(column("theodorsen_sears", "k"), reference=reference)
    np.testing.assert_allclose(S.real, column("theodorsen_sears", f"{name}_re"), rtol=0, atol=EXACT)
    np.testing.assert_allclose(S.imag, column("theodorsen_sears", f"{name}_im"), rtol=0, atol=EXACT)


def test_wagner():
    np.testing.assert_allclose(wagner_function(column("wagner", "s")), column("wagner", "phi"), rtol=0, atol=EXACT)


def test_kussner():
    np.testing.assert_allclose(kussner_function(column("kussner", "s")), column("kussner", "psi"), rtol=0, atol=EXACT)


@pytest.mark.parametrize(
    ("table", "key", "approximation", "exact"),
    [
        ("wagner_approx_error_0_50", "RT_Jones_0.165/0.0455_0.335/0.3", WAGNER_R_T_JONES, wagner_function),
        ("wagner_approx_error_0_50", "WP_Jones_0.165/0.041_0.335/0.32", WAGNER_W_P_JONES, wagner_function),
        ("wagner_approx_error_0_50", "Garrick_(s+2)/(s+4)", garrick_wagner, wagner_function),
        ("kussner_approx_error_0_50", "SearsSparks_0.5/0.13_0.5/1", KUSSNER_SEARS_SPARKS, kussner_function),
        ("kussner_approx_error_0_50", "Leishman_0.5792/0.1393_0.4208/1.802", KUSSNER_LEISHMAN, kussner_function),
        ("kussner_approx_error_0_50", "rational_(s2+s)/(s2+2.82s+0.80)", rational_kussner, kussner_function),
    ],
)
def test_errors_of_step_approximations(table, key, approximation, exact):
    s = np.arange(2001) * 0.025
    error = np.abs(approximation(s) - exact(s))
    assert abs(error.max() - REFERENCE[table][key]["max_abs"]) < EXACT
    assert abs(s[error.argmax()] - REFERENCE[table][key]["at"]) < 1e-9


@pytest.mark.parametrize(("key", "approximation"), [("RT_Jones", WAGNER_R_T_JONES), ("WP_Jones", WAGNER_W_P_JONES)])
def test_errors_of_deficiency_approximations(key, approximation):
    def error(k):
        return np.abs(approximation.frequency_response(1j * k) - theodorsen_function(k))

    stated = REFERENCE["Ck_approx_error"][key]
    assert abs(error(stated["at_k"]) - stated["max_abs"]) < EXACT
    k = np.geomspace(1e-3, 1e2, 2001)
    i = error(k).argmax()
    peak = minimize_scalar(lambda k: -error(k), bounds=(k[i - 1], k[i + 1]), method="bounded")
    assert 0.0 <= -peak.fun - stated["max_abs"] < GRID
