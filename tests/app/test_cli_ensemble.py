"""`simulate --runs`: seeds and parameters, workers, resume, Ctrl-C; and the doublet."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.aircraft.files import read
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario
from aeroservo.studies.monte_carlo import Spread, VariedModel, drawn, variants

Cli = Callable[..., Any]
RUN = ("simulate", "thesis-simulation", "--speed", 35, "--turbulence", 1, "--duration", 1)
VARY = ("--vary", "model.CL_alpha=normal:3.68:0.2", "--vary", "model.K_theta_N_m_rad=uniform:350:450")


def test_same_whatever_the_workers(cli: Cli, tmp_path: Path) -> None:
    """Seeds alone, then seeds and parameters: one process and two, bit for bit; the file has a row for each run."""
    for i, more in enumerate(((), VARY)):
        files = [tmp_path / f"{i}{workers}.csv" for workers in (1, 2)]
        for workers, file in zip((1, 2), files):
            assert cli(*RUN, "--runs", 30, "--workers", workers, *more, "--out", file, "--json").json["survived"] == 30
            assert not file.with_name(file.name + ".part").exists()
        assert files[0].read_text() == files[1].read_text()
        rows = list(csv.DictReader(files[0].read_text().splitlines()))
        assert len(rows) == 30 and len({row["rms_pitch_rad"] for row in rows}) == 30
        if more:
            stiffness = [float(row["model.K_theta_N_m_rad"]) for row in rows]
            assert 350.0 <= min(stiffness) < 370.0 < 430.0 < max(stiffness) <= 450.0


def test_statistics_are_those_of_the_rows(cli: Cli, tmp_path: Path) -> None:
    """JSON: mean, quantiles and largest of what `per_run` lists; more runs later leave the first ones as they were."""
    file = tmp_path / "runs.json"
    answer = cli(*RUN, "--runs", 12, "--workers", 1, *VARY, "--seed", 3, "--out", file, "--json").json
    kept = json.loads(file.read_text())
    pitch = kept["per_run"]["peak_pitch_rad"]
    found = answer["peak"]["pitch_rad"]
    assert found["mean"] == pytest.approx(np.mean(pitch)) and found["largest"] == max(pitch)
    assert found["p95"] == pytest.approx(np.quantile(pitch, 0.95)) and found["median"] == pytest.approx(
        np.median(pitch)
    )
    more = cli(*RUN, "--runs", 15, "--workers", 1, *VARY, "--seed", 3, "--json").json
    assert more["varied"]["model.CL_alpha"][:12] == answer["varied"]["model.CL_alpha"]
    people = cli(*RUN, "--runs", 2, "--workers", 1)
    assert people.code == 0 and "2 of 2 runs" in people.out and "peak of" in people.out


def test_interrupt_keeps_what_is_done(tmp_path: Path) -> None:
    """Ctrl-C at the terminal (the whole group gets it): code 1, no traceback, and the same command goes on."""
    words = [str(w) for w in (*RUN[:-1], 20, "--runs", 2000, "--workers", 2, "--out", "r.csv")]
    start = [sys.executable, "-m", "aeroservo.cli", *words]
    journal = tmp_path / "r.csv.part"

    def stopped_after(tasks: int) -> tuple[int, bytes, str]:
        run = subprocess.Popen(
            start, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )
        deadline = time.monotonic() + 240.0  # for machines that are busy with other things
        while not (journal.exists() and journal.read_bytes().count(b"\n") > tasks):
            assert time.monotonic() < deadline and run.poll() is None
            time.sleep(0.02)
        os.killpg(run.pid, signal.SIGINT)
        _, error = run.communicate(timeout=240)
        return run.returncode, error, journal.read_text()

    code, error, lines = stopped_after(1)
    assert code == 1 and b"Traceback" not in error and b"the same command goes on" in error, error.decode()
    done = lines.count("\n") - 1
    assert 0 < done < 80 and not (tmp_path / "r.csv").exists()
    code, error, more = stopped_after(done + 1)
    assert code == 1 and b"Traceback" not in error
    assert more.startswith(lines) and len(more) > len(lines)  # what was there is taken up, not computed again


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--runs", 0), "at least 1"),
        (("--workers", 2), "go with --runs"),
        (("--vary", "model.CL_alpha=normal:3:1"), "go with --runs"),
        (("--runs", 2, "--plot", "a.png"), "draws one run"),
        (("--runs", 2, "--out", "a.nc"), ".csv"),
        (("--runs", 2, "--vary", "model.CL_alpha=normal:3"), "FIELD=normal:MEAN:SD"),
        (("--runs", 2, "--vary", "model.CL_alpha=cauchy:3:1"), "must be one of normal, uniform"),
        (("--runs", 2, "--vary", "model.CL_alpha=normal:3:-1"), "must not be negative"),
        (("--runs", 2, "--vary", "model.CL_alpha=normal:3:inf"), "finite"),
        (("--runs", 2, "--vary", "model.CL_alpha=uniform:3:1"), "above the highest"),
        (("--runs", 2, "--vary", "model.CL=normal:3:1"), "is not a number of this model"),
        (("--runs", 2, "--vary", "model.m_kg=normal:0.1:5"), "take a narrower law"),
        (("--runs", 2, *VARY[:2], *VARY[:2]), "vary once"),
        (("--doublet", "5:0.5"), "DEG:S@T"),
        (("--doublet", "rudder=5:0.5@1"), "which is no command"),
    ],
)
def test_refusals(cli: Cli, words: tuple[Any, ...], message: str) -> None:
    """Code 2 and the reason."""
    answer = cli(*RUN, *words)
    assert answer.code == 2 and message in answer.err, answer.err


def test_matrices_do_not_vary(cli: Cli) -> None:
    """Kind state_space: runs over seeds, but no parameters."""
    words = ("simulate", "thesis-appendix", "--duration", 1, "--workers", 1)
    assert cli(*words, "--runs", 2, "--json").json["done"] == 2
    assert "holds matrices" in cli(*words, "--runs", 2, "--vary", "model.speed_m_s=normal:3:1").err


def test_doublet(cli: Cli) -> None:
    """5 degrees one way and back; two of them on a named control add up."""
    peak = cli("simulate", "bact", "--speed", 50, "--doublet", "5:0.5@1", "--duration", 3, "--json").json["peak"]
    assert peak["elevon_command_rad"] == pytest.approx(np.radians(5.0), rel=1e-12)
    both = ("--doublet", "elevon=5:0.5@1", "--doublet", "elevon=2:0.5@1")
    peak = cli("simulate", "bact", "--speed", 50, *both, "--duration", 3, "--json").json["peak"]
    assert peak["elevon_command_rad"] == pytest.approx(np.radians(7.0), rel=1e-12)


def test_draws() -> None:
    """Of the seed, the field and the run alone; laws have their moments; sampled air forces are fitted."""
    one = Spread(field="model.m_kg", law="normal", first=10.0, second=0.5)
    values = np.array([drawn(one, seed=1, run=run) for run in range(2000)])
    assert abs(values.mean() - 10.0) < 4.0 * 0.5 / np.sqrt(2000) and abs(values.std() / 0.5 - 1.0) < 0.07
    two = Spread(field="model.c_m", law="uniform", first=0.0, second=1.0)
    other = np.array([drawn(two, seed=1, run=run) for run in range(2000)])
    assert 0.0 <= other.min() < 0.01 and 0.99 < other.max() < 1.0 and abs(np.corrcoef(values, other)[0, 1]) < 0.1
    goland = read("goland")
    model = VariedModel(file=goland, changes=(("wing.station[0].GJ_N_m2", 1e6),))
    assert len(model().aero.lags) > 0
    with pytest.raises(ValueError, match="rational fit is off"):
        VariedModel(file=goland, changes=model.changes, fit_bound=1e-9)()
    scenario = Scenario(profile=level(30.0), duration=1.0)
    names = [v.name for v in variants(read("bact"), [one], scenario, runs=3)]
    assert names == ["run 0", "run 1", "run 2"]
