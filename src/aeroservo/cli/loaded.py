"""What every computing command does first and last: read, build, tell, draw."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from aeroservo.cli.options import AeroTheory, sweep_of
from aeroservo.cli.output import complain, not_yet, write

if TYPE_CHECKING:
    from collections.abc import Iterable

    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import AeroelasticModel

#: Air forces that are samples of reduced frequency: no state space without a fit.
SAMPLED = (AeroTheory.theodorsen, AeroTheory.dlm)


def load(
    name: str, aero: AeroTheory | None, speeds: str | None = None
) -> tuple[FileModel, AeroelasticModel, tuple[str, ...]]:
    """The file, the model that it describes, and what is odd about it.

    Parameters
    ----------
    name : str
        Preset or path.
    aero : AeroTheory, optional
        Air forces; by kind of model if not given.
    speeds : str, optional
        The option `--speeds`, refused here if it is wrong, before any work.

    Returns
    -------
    file, model, notes : FileModel, AeroelasticModel, tuple of str
        What was read, what was built, what to know about it.

    Raises
    ------
    Exit
        With code 2 for air forces that do not exist yet.
    """
    from aeroservo.aircraft.files import read

    file = read(name)
    sweep_of(file, speeds)
    if aero is AeroTheory.dlm:
        not_yet("--aero dlm (an unsteady lattice)")
    return file, built(file, aero), file.problems()


def built(file: FileModel, aero: AeroTheory | None = None) -> AeroelasticModel:
    """The model that a file describes; what the mechanics refuse is told with the name of the model.

    Parameters
    ----------
    file : FileModel
        Read.
    aero : AeroTheory, optional
        Air forces; by kind of model if not given.

    Returns
    -------
    model : AeroelasticModel
        Without airspeed or density.

    Raises
    ------
    ValueError
        If the file is well formed but no such model exists.
    """
    from aeroservo.aeroelastic.build import build

    try:
        return build(file, aero.value if aero else None)
    except ValueError as error:
        if type(error) is ValueError:
            raise ValueError(f"{file.name}: {error}") from error
        raise


def is_buildable(file: FileModel) -> bool:
    """Whether there are analyses for this kind of model.

    Parameters
    ----------
    file : FileModel
        Read.

    Returns
    -------
    buildable : bool
        As far as `build` goes; an aircraft without a structure is rigid, and that is no fault.
    """
    from aeroservo.aeroelastic.build import DEFAULTS
    from aeroservo.aircraft.aircraft_schema import AircraftFile

    return file.kind in DEFAULTS and not (isinstance(file, AircraftFile) and file.structure is None)


def rational(model: AeroelasticModel, bound: float) -> AeroelasticModel:
    """The model with air forces that have a state space; a fit is told on stderr.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    bound : float
        Largest allowed error of the fit, part of the largest |Q| of each column. [-]

    Returns
    -------
    model : AeroelasticModel
        With rational air forces.

    Raises
    ------
    ValueError
        If the fit is worse than the bound.
    """
    from dataclasses import replace

    from aeroservo.aero.rational import fit_rational
    from aeroservo.datatypes import SampledAero

    if not isinstance(model.aero, SampledAero):
        return model
    fit = fit_rational(model.aero)
    if fit.error > bound:
        raise ValueError(
            f"the rational fit of these air forces is off by {100.0 * fit.error:.2f} % of the largest |Q| of column "
            f"{fit.worst_input!r}, more than --fit-bound {bound:g} allows"
        )
    tell_fit(fit.error)
    return replace(model, aero=fit.aero)


def tell_fit(error: float) -> None:
    """Say on stderr how good a rational fit is.

    Parameters
    ----------
    error : float
        Part of the largest |Q| of each column. [-]
    """
    complain(f"rational fit of the air forces: off by at most {100.0 * error:.3g} % of the largest |Q| of a column")


def tell(notes: Iterable[str]) -> None:
    """Say on stderr what to know before trusting the numbers.

    Parameters
    ----------
    notes : iterable of str
        One sentence each.
    """
    assumed = 0
    for note in notes:
        if note.startswith("assumed: "):
            assumed += 1
        else:
            complain(f"warning: {note}")
    if assumed:
        complain(f"the model rests on {assumed} stated assumption{'s' * (assumed > 1)}: `aeroservo check` lists them")


def altitude_of(altitude: float | None, density: float | None) -> float | None:
    """The altitude in force: none where a density is given.

    Parameters
    ----------
    altitude, density : float, optional
        The options. [m, kg/m^3]

    Returns
    -------
    altitude : float or None
        Geopotential. [m]
    """
    return None if density is not None else (altitude or 0.0)


def air(head: dict[str, Any]) -> str:
    """The air in words.

    Parameters
    ----------
    head : dict
        Of `heading`.

    Returns
    -------
    text : str
        Altitude, if there is one, and density.
    """
    altitude, density = head["altitude_m"], f"{head['density_kg_m3']:.6g} kg/m3"
    return density if altitude is None else f"{altitude:g} m ({density})"


def draw(path: Path, figure: Any) -> None:
    """Write a figure, whole or not at all.

    Parameters
    ----------
    path : Path
        Where to; its ending is the format.
    figure : matplotlib Figure
        Of `report.figures`.
    """
    from aeroservo.report.figures import as_bytes

    write(path, as_bytes(figure, path.suffix))
