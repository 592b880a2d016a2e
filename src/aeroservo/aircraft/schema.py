"""The kinds of model file, by name, and the JSON Schema that editors use to check and complete them."""

from __future__ import annotations

import json
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any, Union, get_args

from pydantic import Field, TypeAdapter

from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.aircraft.schema_other import ModalFile, PitchPlungeFlap, StateSpaceFile
from aeroservo.aircraft.schema_section import TypicalSection
from aeroservo.aircraft.schema_wing import BinaryWing, WholeAircraft

#: Where the shipped JSON Schema lies.
SCHEMA_FILE = Path(__file__).with_name("model.schema.json")

_KINDS: tuple[type[FileModel], ...] = (
    TypicalSection,
    BinaryWing,
    WholeAircraft,
    BeamWing,
    ModalFile,
    PitchPlungeFlap,
    StateSpaceFile,
)
_LATER = "aeroservo.aircraft.aircraft_schema"


def kinds() -> dict[str, type[FileModel]]:
    """The model class of each `kind`.

    Returns
    -------
    kinds : dict of str to type
        In the order of the manual.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> kinds()["beam_wing"].__name__
    'BeamWing'
    """
    return {kind_of(model): model for model in (*_KINDS, *_aircraft())}


def kind_of(model: type[FileModel]) -> str:
    """The word that a model class answers to.

    Parameters
    ----------
    model : type
        A subclass of `FileModel` whose `kind` is a `Literal`.

    Returns
    -------
    kind : str
        Its only allowed value.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> kind_of(TypicalSection)
    'typical_section'
    """
    return str(get_args(model.model_fields["kind"].annotation)[0])


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of every kind of model file.

    Returns
    -------
    schema : dict
        Ready for `json.dump`; shipped as `aircraft/model.schema.json`.

    References
    ----------
    JSON Schema, draft 2020-12; project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> json_schema()["discriminator"]["propertyName"]
    'kind'
    """
    union = Annotated[Union[tuple(kinds().values())], Field(discriminator="kind")]  # type: ignore[valid-type]  # noqa: UP007
    adapter: TypeAdapter[Any] = TypeAdapter(union)  # type: ignore[arg-type]
    schema = adapter.json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "aeroservo model file",
        "description": "TOML model file of aeroservo; SI units are part of the names",
        **schema,
    }


def write_json_schema(path: Path = SCHEMA_FILE) -> None:
    """Write the JSON Schema, as `python -m aeroservo.aircraft.schema` does.

    Parameters
    ----------
    path : Path
        Where to; the shipped file by default.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json_schema(Path(folder) / "model.schema.json")
    """
    path.write_text(json.dumps(json_schema(), indent=1) + "\n", encoding="utf-8")


def _aircraft() -> tuple[type[FileModel], ...]:
    """The class of kind "aircraft", once its module is there."""
    if find_spec(_LATER) is None:
        return ()
    module = import_module(_LATER)
    found = [
        thing
        for thing in vars(module).values()
        if isinstance(thing, type)
        and issubclass(thing, FileModel)
        and thing.__module__ == _LATER
        and get_args(thing.model_fields["kind"].annotation) == ("aircraft",)
    ]
    return tuple(found[:1])


if __name__ == "__main__":
    write_json_schema()
