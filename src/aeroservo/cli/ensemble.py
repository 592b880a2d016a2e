"""`simulate --runs`: many runs over seeds and over numbers of the model file, on several processes."""

from __future__ import annotations

import csv
import os
from contextlib import nullcontext
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from aeroservo.cli.boundary import tell_progress
from aeroservo.cli.options import AeroTheory
from aeroservo.cli.output import complain, number, print_json, table, write, write_json

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import AeroelasticModel, LinearSystem
    from aeroservo.simulate.montecarlo import Ensemble, Variant
    from aeroservo.simulate.scenario import Scenario
    from aeroservo.studies.monte_carlo import Spread

#: Runs in one task where only the seed differs: what is done is kept in steps of so many.
BATCH = 25
#: Parts of the runs that lie below: the median and the ends of nine tenths.
QUANTILES = {"p5": 0.05, "median": 0.5, "p95": 0.95}


def run_many(
    head: dict[str, Any],
    file: FileModel,
    plant: AeroelasticModel | LinearSystem,
    scenario: Scenario,
    *,
    runs: int,
    workers: int | None,
    vary: list[str],
    seed: int,
    aero: AeroTheory | None,
    fit_bound: float,
    out: Path | None,
    as_json: bool,
) -> None:
    """Run, write and print an ensemble. While it runs, what is done is kept in OUT.part; a second call goes on.

    Parameters
    ----------
    head : dict
        Keys that every JSON has.
    file : FileModel
        The model file.
    plant : AeroelasticModel or LinearSystem
        What is simulated where no number varies.
    scenario : Scenario
        What happens.
    runs, workers : int
        How many, on how many processes (default one for each core).
    vary : list of str
        FIELD=normal:MEAN:SD or FIELD=uniform:LOW:HIGH.
    seed : int
        Of draws, turbulence and noise.
    aero : AeroTheory, optional
        Air forces.
    fit_bound : float
        Largest error of a rational fit. [-]
    out : Path, optional
        .csv with a row for each run, or .json.
    as_json : bool
        As JSON.

    Raises
    ------
    Exit
        With code 1 if it was stopped before all runs were done.
    ValueError
        For bad input.
    """
    from aeroservo.datatypes import LinearSystem
    from aeroservo.simulate.montecarlo import Variant, ensemble, local_pool
    from aeroservo.studies.monte_carlo import variants

    if runs < 1 or (workers is not None and workers < 1):
        raise ValueError(f"--runs and --workers must be at least 1, got {runs} and {workers}")
    spreads = [_spread(text) for text in vary]
    if spreads and isinstance(plant, LinearSystem):
        raise ValueError(f"{file.name}: --vary needs a model of parameters; kind {file.kind!r} holds matrices")
    cases: tuple[Variant, ...] = (Variant(name=file.name, model=plant, scenario=scenario),)
    if spreads:
        word = aero.value if aero else None
        cases = variants(file, spreads, scenario, runs=runs, seed=seed, aero=word, fit_bound=fit_bound)
    count = workers or os.cpu_count() or 1
    journal = None if out is None else out.with_name(out.name + ".part")
    with nullcontext() if count == 1 else local_pool(count) as pool:
        found = ensemble(
            cases,
            runs=1 if spreads else runs,
            seed=seed,
            executor=pool,
            batch=1 if spreads else BATCH,
            journal=journal,
            progress=lambda done, total: tell_progress(done, total, "runs"),
        )
    values = {s.field: [dict(_changes(v))[s.field] for v in cases] for s in spreads}
    complete = bool(found.done.all())
    content = (
        head | {"seed": seed, "runs": runs, "done": int(found.done.sum())} | _statistics(found) | {"varied": values}
    )
    if not complete:
        kept = "" if journal is None else f"; what is done is in {journal}, the same command goes on from there"
        complain(f"stopped with {content['done']} of {runs} runs done{kept}")
    elif out is not None and journal is not None:
        if out.suffix.lower() == ".csv":
            write(out, _rows(found, values).encode())
        else:
            write_json(out, content | {"per_run": _per_run(found)})
        journal.unlink(missing_ok=True)
    if as_json:
        print_json(content)
    else:
        _print(str(head["model"]), content)
    if not complete:
        raise typer.Exit(1)


def _spread(text: str) -> Spread:
    """FIELD=normal:MEAN:SD or FIELD=uniform:LOW:HIGH."""
    from aeroservo.studies.monte_carlo import Spread

    field, _, rest = text.partition("=")
    law, *numbers = rest.split(":")
    try:
        first, second = map(float, numbers)
    except ValueError:
        raise ValueError(
            f"--vary {text[:80]!r} must be FIELD=normal:MEAN:SD or FIELD=uniform:LOW:HIGH, in the unit of the field"
        ) from None
    return Spread(field=field.strip(), law=law.strip(), first=first, second=second)  # type: ignore[arg-type]


def _changes(variant: Variant) -> tuple[tuple[str, float], ...]:
    """Values of the fields in a run."""
    from aeroservo.studies.monte_carlo import VariedModel

    assert isinstance(variant.model, VariedModel)
    return variant.model.changes


def _statistics(found: Ensemble) -> dict[str, Any]:
    """Over the runs that are done."""
    done = found.done
    content: dict[str, Any] = {"survived": int(found.survived[done].sum())}
    for name in ("peak", "rms"):
        values = getattr(found, name)[done]
        content[name] = {
            channel: {"mean": float(np.mean(column)), "largest": float(np.max(column))}
            | {word: float(np.quantile(column, part)) for word, part in QUANTILES.items()}
            for channel, column in zip(found.channels, values.T)
            if len(column)
        }
    content["duration_s"] = {"least": float(found.duration[done].min())} if done.any() else None
    return content


def _per_run(found: Ensemble) -> dict[str, Any]:
    """Columns, one entry for each run."""
    columns = {"survived": found.survived.ravel().tolist(), "duration_s": found.duration.ravel().tolist()}
    for name in ("peak", "rms"):
        flat = getattr(found, name).reshape(-1, len(found.channels))
        columns |= {f"{name}_{channel}": flat[:, j].tolist() for j, channel in enumerate(found.channels)}
    return columns


def _rows(found: Ensemble, values: dict[str, list[float]]) -> str:
    """A table with a row for each run."""
    columns: dict[str, Any] = {"run": list(range(found.done.size))} | values | _per_run(found)
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values()))
    return text.getvalue()


def _print(name: str, content: dict[str, Any]) -> None:
    """The result for people."""
    typer.echo(f"{name}: {content['done']} of {content['runs']} runs, seed {content['seed']}")
    if content["duration_s"] is not None:
        least = number(content["duration_s"]["least"], "s")
        typer.echo(f"reached the end: {content['survived']} of {content['done']}; shortest run {least}")
    for what in ("peak", "rms"):
        rows = [(channel, *cells.values()) for channel, cells in content[what].items()]
        typer.echo(table(rows, (f"{what} of", "mean", "largest", *QUANTILES)))
