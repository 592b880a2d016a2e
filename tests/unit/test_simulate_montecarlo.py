"""Many runs: the same whatever the workers, interruptible, resumable."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import aeroservo as av
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import linearised
from aeroservo.simulate.montecarlo import Variant, ensemble, local_pool, run_seeds
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario


def variants() -> tuple[Variant, ...]:
    """Two speeds in turbulence."""
    plant = replace(linearised(av.build(av.read("thesis-simulation"))), limits=())
    return tuple(
        Variant(
            name=f"{V:g} m/s",
            model=plant,
            scenario=Scenario(profile=level(V), duration=0.5, turbulence=Gustiness(level=1.0)),
        )
        for V in (30.0, 38.0)
    )


def test_workers_do_not_matter() -> None:
    """One process, two processes, other batches: bit for bit the same."""
    alone = ensemble(variants(), runs=6, seed=9, batch=6)
    with local_pool(2) as pool:
        shared = ensemble(variants(), runs=6, seed=9, batch=2, executor=pool)
    for name in ("peak", "rms", "duration"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(shared, name))
    assert alone.done.all() and alone.survived.all()
    pitch = alone.channels.index("pitch_rad")
    assert len(np.unique(alone.rms[:, :, pitch])) == 12
    other = ensemble(variants(), runs=6, seed=10, batch=6)
    assert not np.any(other.rms[..., pitch] == alone.rms[..., pitch])


def test_seeds_depend_on_their_numbers_only() -> None:
    """A run's seed is that of its number: more runs later change nothing of the first ones."""
    assert run_seeds(1, 0, range(5)) == run_seeds(1, 0, range(3)) + run_seeds(1, 0, [3, 4])
    assert len({*run_seeds(1, 0, range(50)), *run_seeds(1, 1, range(50)), *run_seeds(2, 0, range(50))}) == 150


def test_interrupt_loses_nothing_and_resumes(tmp_path: Path) -> None:
    """Ctrl-C after the third task; a torn last line as of a kill; the rest is computed, the first is not again."""
    journal, seen = tmp_path / "runs.jsonl", []

    def stop(done: int, total: int) -> None:
        seen.append(done)
        if len(seen) == 3:
            raise KeyboardInterrupt

    whole = ensemble(variants(), runs=4, seed=2, batch=1)
    part = ensemble(variants(), runs=4, seed=2, batch=1, journal=journal, progress=stop)
    assert part.done.sum() == 3 and np.isnan(part.rms[~part.done]).all()
    np.testing.assert_array_equal(part.rms[part.done], whole.rms[part.done])
    with open(journal, "a") as file:
        file.write('{"task": [1, 2], "fou')
    seen.clear()
    rest = ensemble(
        variants(), runs=4, seed=2, batch=1, journal=journal, progress=lambda done, total: seen.append(done)
    )
    assert seen == [4, 5, 6, 7, 8]
    np.testing.assert_array_equal(rest.rms, whole.rms)
    again: list[int] = []
    ensemble(variants(), runs=4, seed=2, batch=1, journal=journal, progress=lambda done, total: again.append(done))
    assert again == []
    with pytest.raises(ValueError, match="another ensemble"):
        ensemble(variants(), runs=4, seed=3, batch=1, journal=journal)


_VARIED = """
import sys
import aeroservo as av
from aeroservo.simulate.montecarlo import ensemble
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario
from aeroservo.studies.monte_carlo import Spread, variants

spread = Spread(field="model.m_kg", law="normal", first=float(sys.argv[2]), second=0.1)
cases = variants(av.read("thesis-simulation"), [spread], Scenario(profile=level(30.0), duration=0.01), runs=2, seed=0)
ensemble(cases, runs=1, seed=0, batch=1, journal=sys.argv[1], progress=lambda done, total: print(done))
"""


def test_journal_of_varied_models_is_known_in_another_process(tmp_path: Path) -> None:
    """Its fingerprint may not follow the order of sets, which Python draws anew in each process."""

    def run(hash_seed: str, mean: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", _VARIED, str(tmp_path / "runs.jsonl"), mean]
        return subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONHASHSEED": hash_seed})

    assert run("1", "10").stdout.split() == ["1", "2"]
    again = run("2", "10")
    assert (again.returncode, again.stdout) == (0, ""), again.stderr
    assert "another ensemble" in run("2", "11").stderr


def test_refusals() -> None:
    """Nothing to run, names twice."""
    with pytest.raises(ValueError, match="at least 1"):
        ensemble((), runs=1)
    one = variants()[0]
    with pytest.raises(ValueError, match="differ"):
        ensemble((one, one), runs=1)
