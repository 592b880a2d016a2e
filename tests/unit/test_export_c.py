"""The C99 export against the Python reference and the compiled engine, and what it refuses."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from aeroservo.control.controller import Controller, state_feedback
from aeroservo.control.export_c import c_header, c_source
from aeroservo.control.response import controller_response
from aeroservo.simulate import _kernels

CC = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
needs_compiler = pytest.mark.skipif(CC is None, reason="no C compiler (cc, gcc, clang) on this machine")
FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wmissing-prototypes", "-O2")

#: Reads n_in measurements and the pressure of each sample, writes the code of the step and n_out commands.
MAIN = """
#include <stdio.h>
#include "loop.h"
int main(void) {{
  double in[{n_in} + 1], out[{n_out} + 1] = {{0}};
  loop_state s;
  loop_init(&s);
  while (fread(in, sizeof(double), {n_in} + 1, stdin) == {n_in} + 1) {{
    out[0] = (double)loop_step(&s, in, in[{n_in}], out + 1);
    if (fwrite(out, sizeof(double), {n_out} + 1, stdout) != {n_out} + 1) return 2;
  }}
  return 0;
}}
"""


def schedule(points: int = 7, n_c: int = 5, n_in: int = 3, n_out: int = 2, *, limits: bool = True) -> Controller:
    """A stable random controller whose commands reach their limits often."""
    rng = np.random.default_rng(3)
    A = rng.standard_normal((points, n_c, n_c))
    A *= 0.9 / np.abs(np.linalg.eigvals(A)).max(axis=1)[:, None, None] if n_c else 1.0
    return Controller(
        A=A,
        B=rng.standard_normal((points, n_c, n_in)),
        C=rng.standard_normal((points, n_out, n_c)),
        D=rng.standard_normal((points, n_out, n_in)),
        windup=0.1 * rng.standard_normal((points, n_c, n_out)),
        inputs=tuple(f"y{i}_rad" for i in range(n_in)),
        outputs=tuple(f"u{i}_rad" for i in range(n_out)),
        dt_s=0.005,
        limits=(4.0, 0.0)[:n_out] if limits else (),
        pressures=np.cumsum(rng.uniform(100.0, 900.0, points)),
    )


def compiled(controller: Controller, folder: Path, measured: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Codes and commands of the C code for a record, shape (n, 1 + n_out)."""
    assert CC is not None
    n_in, n_out = len(controller.inputs), len(controller.outputs)
    (folder / "loop.c").write_text(c_source(controller, name="loop"), encoding="ascii")
    (folder / "loop.h").write_text(c_header(controller, name="loop"), encoding="ascii")
    (folder / "main.c").write_text(MAIN.format(n_in=n_in, n_out=n_out), encoding="ascii")
    built = subprocess.run(
        [CC, *FLAGS, "loop.c", "main.c", "-o", "loop"], cwd=folder, capture_output=True, text=True, timeout=60
    )
    assert built.returncode == 0, built.stderr
    record = np.concatenate([measured, pressure[:, None]], axis=1).astype(float).tobytes()
    run = subprocess.run([folder / "loop"], input=record, capture_output=True, timeout=60)
    assert run.returncode == 0
    return np.frombuffer(run.stdout).reshape(-1, 1 + n_out)


@needs_compiler
def test_hundred_thousand_samples_bit_by_bit(tmp_path: Path) -> None:
    """Schedule, limits and anti-windup included; the pressure leaves the schedule at both ends and meets its points."""
    c, n = schedule(), 100_000
    rng = np.random.default_rng(11)
    measured = rng.standard_normal((n, 3))
    width = np.ptp(c.pressures)
    pressure = rng.uniform(c.pressures[0] - 0.2 * width, c.pressures[-1] + 0.2 * width, n)
    pressure[::50] = rng.choice(c.pressures, len(pressure[::50]))
    expected, _ = controller_response(c, measured, pressure)
    got = compiled(c, tmp_path, measured, pressure)
    assert not np.any(got[:, 0])
    np.testing.assert_array_equal(got[:, 1:], expected)
    limited = np.abs(expected[:, 0]) == 4.0
    assert 0.05 < limited.mean() < 0.95  # the limits were met, and left again
    assert np.any(np.abs(expected[:, 1]) > 4.0)  # 0 is no limit
    assert np.any(pressure < c.pressures[0]) and np.any(pressure > c.pressures[-1])


@needs_compiler
@pytest.mark.parametrize("points", [1, 2])
def test_without_states_and_with_two_points(tmp_path: Path, points: int) -> None:
    c = schedule(points, n_c=0, n_in=1, n_out=1)
    rng = np.random.default_rng(5)
    measured, pressure = 3.0 * rng.standard_normal((2000, 1)), rng.uniform(0.0, 3000.0, 2000)
    expected, _ = controller_response(c, measured, pressure)
    np.testing.assert_array_equal(compiled(c, tmp_path, measured, pressure)[:, 1:], expected)


@needs_compiler
def test_what_is_not_finite_changes_nothing(tmp_path: Path) -> None:
    """A sample with a NaN or an infinity is answered by 1 and skipped: the others are as if it had not come."""
    c = schedule()
    rng = np.random.default_rng(2)
    measured, pressure = rng.standard_normal((60, 3)), rng.uniform(0.0, 4000.0, 60)
    bad = np.zeros(60, bool)
    bad[[3, 17, 40]] = True
    measured[3, 1], measured[17, 0], pressure[40] = np.nan, np.inf, -np.inf
    got = compiled(c, tmp_path, measured, pressure)
    np.testing.assert_array_equal(got[:, 0], bad)
    np.testing.assert_array_equal(got[~bad, 1:], controller_response(c, measured[~bad], pressure[~bad])[0])
    np.testing.assert_array_equal(got[3, 1:], got[2, 1:])


def test_python_is_the_engine_bit_by_bit() -> None:
    """The kernel that the engine steps makes the same sums."""
    c = schedule()
    rng = np.random.default_rng(7)
    measured, pressure = rng.standard_normal((500, 3)), rng.uniform(0.0, 5000.0, 500)
    weights = c.blend(pressure)
    above = np.concatenate([c.A, c.B, c.windup], axis=2)
    below = np.concatenate([c.C, c.D, np.zeros((7, 2, 2))], axis=2)
    matrices = np.concatenate([above, below], axis=1)
    x, work, command, got = np.zeros(5), np.zeros(10), np.zeros(2), np.zeros((500, 2))
    for k in range(500):
        _kernels.control(
            matrices, (5, 3, 2), weights, k, measured[k : k + 1], 0, np.zeros(3, np.int64), np.zeros((500, 3)),
            np.zeros(3), np.array(c.limits), x, work, command,
        )  # fmt: skip
        got[k] = command
    expected, state = controller_response(c, measured, pressure)
    np.testing.assert_array_equal(got, expected)
    np.testing.assert_array_equal(x, state)


def test_response_is_the_linear_system_where_nothing_is_limited() -> None:
    """A second route: powers of A; and a record cut in two is the whole record."""
    c = schedule(1, limits=False)
    rng = np.random.default_rng(1)
    y = rng.standard_normal((40, 3))
    x, expected = np.zeros(5), []
    for sample in y:
        expected.append(c.C[0] @ x + c.D[0] @ sample)
        x = c.A[0] @ x + c.B[0] @ sample
    got, state = controller_response(c, y)
    np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-12)
    first, middle = controller_response(c, y[:13])
    second, end = controller_response(c, y[13:], state=middle)
    np.testing.assert_array_equal(np.concatenate([first, second]), got)
    np.testing.assert_array_equal(end, state)


def test_limited_command_drives_the_state() -> None:
    """An integrator with back-calculation leaves its limit at the next sample of the other sign; without, not."""
    matrices = {"A": [[1.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]]}
    names = {"inputs": ("e",), "outputs": ("u",), "dt_s": 0.1, "limits": (1.0,)}
    y = np.concatenate([np.ones(20), -np.ones(3)])[:, None]
    held = controller_response(Controller(**matrices, **names, windup=[[1.0]]), y)[0][:, 0]  # type: ignore[arg-type]
    wound = controller_response(Controller(**matrices, **names), y)[0][:, 0]  # type: ignore[arg-type]
    assert held[20] == 1.0 and held[21] < 1.0
    assert np.all(wound[2:] == 1.0)


@pytest.mark.parametrize("name", ["", "9x", "a b", "int", "x" * 42, "a*/b"])
def test_names_that_are_no_identifiers_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="identifier"):
        c_source(state_feedback([[1.0]], ("y",), ("u",), 0.01), name=name)


def test_channel_names_cannot_leave_the_comment() -> None:
    hostile = state_feedback([[1.0]], ("y */ evil();",), ("u\n#error",), 0.01)
    code = c_source(hostile)
    assert code.count("*/") == code.count("/*")
    assert "evil();" not in code and "#error" not in code


def test_continuous_controllers_and_wrong_records_are_refused() -> None:
    continuous = state_feedback([[1.0]], ("y",), ("u",), None)
    for call in (c_source, c_header, lambda c: controller_response(c, [[1.0]])):
        with pytest.raises(ValueError, match="sample time"):
            call(continuous)  # type: ignore[operator]
    c = schedule()
    for measured, pressure, state, words in (
        (np.zeros((4, 2)), np.zeros(4), None, "measured must have shape"),
        (np.zeros((4, 3)), None, None, "needs the dynamic pressure"),
        (np.zeros((4, 3)), np.zeros(3), None, "pressure must have shape"),
        (np.zeros((4, 3)), np.zeros(4), np.zeros(2), "state must have shape"),
        (np.full((4, 3), np.nan), np.zeros(4), None, "must be finite"),
    ):
        with pytest.raises(ValueError, match=words):
            controller_response(c, measured, pressure, state=state)
    runaway = Controller(A=[[10.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], inputs=("y",), outputs=("u",), dt_s=0.1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="runs away"):
        controller_response(runaway, np.ones((400, 1)))
