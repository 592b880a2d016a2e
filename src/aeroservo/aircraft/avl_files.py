"""From an AVL geometry file to a model file of kind `aircraft`."""

from __future__ import annotations

import os
from pathlib import Path

import tomlkit

from aeroservo.aircraft.avl import AvlImport, read_avl
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import write_whole


def new_from_avl(source: str | Path, file: str | Path, *, force: bool = False) -> tuple[Path, tuple[str, ...]]:
    """Write the aircraft of an AVL geometry file as a model file.

    Parameters
    ----------
    source : str or Path
        The AVL file.
    file : str or Path
        Model file to write.
    force : bool
        Replace an existing file.

    Returns
    -------
    path, notes : Path, tuple of str
        The file written, whole or not at all, and what was left out or read in one of several ways.

    Raises
    ------
    ModelFileError
        If the file exists and `force` is not set, or it cannot be written.

    References
    ----------
    M. Drela, H. Youngren, AVL 3.36 user guide, 2017, section "Input file".

    Examples
    --------
    >>> import tempfile
    >>> from aeroservo.aircraft.files import read
    >>> head = "plank\\n0.0\\n0 0 0\\n4 1 4\\n0.25 0 0\\nSURFACE\\nwing\\n8 1\\nYDUP\\n0\\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     n = (Path(folder) / "plank.avl").write_text(head + "SECTION\\n0 0 0 1 0\\nSECTION\\n0 2 0 1 0\\n")
    ...     path, notes = new_from_avl(Path(folder) / "plank.avl", Path(folder) / "plank.toml")
    ...     read(path).derived()["wing_aspect_ratio"]
    4.0
    """
    path = Path(file)
    if path.is_dir():
        raise ModelFileError(f"{path}: is a folder; give the name of the file to write")
    found = read_avl(source)
    try:
        write_whole(path, as_toml(found, Path(source).name, folder=path.parent).encode(), force=force)
    except FileExistsError:
        raise ModelFileError(f"{path}: exists already and is left as it is; --force replaces it") from None
    except (OSError, ValueError) as error:
        raise ModelFileError(f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}") from None
    return path, found.notes


def as_toml(found: AvlImport, source: str, *, folder: Path | None = None) -> str:
    """The text of a model file.

    Parameters
    ----------
    found : AvlImport
        The aircraft read.
    source : str
        Name of the AVL file, for the heading.
    folder : Path, optional
        Where the model file will stand: paths of airfoil files become relative to it.

    Returns
    -------
    text : str
        TOML, with the notes as comments.

    References
    ----------
    Project convention: contract.md, "Model files".

    Examples
    --------
    >>> from aeroservo.aircraft.avl import parse_avl
    >>> head = "fin\\n0\\n0 0 0\\n1 1 1\\n0 0 0\\nSURFACE\\nfin\\n4 1\\n"
    >>> as_toml(parse_avl(head + "SECTION\\n0 0 0 1 0\\nSECTION\\n0.3 0 1 0.5 0\\n"), "fin.avl").splitlines()[0]
    '# From fin.avl (AVL). Masses ([[mass]]) and structure ([structure]) are not in such a file: add them here.'
    """
    document = tomlkit.document()
    document.add(
        tomlkit.comment(
            f"From {source} (AVL). Masses ([[mass]]) and structure ([structure]) are not in such a file: add them here."
        )
    )
    for note in found.notes:
        document.add(tomlkit.comment(note.replace("\n", " ")))
    if found.mach:
        document.add(tomlkit.comment(f"The file is for Mach {found.mach:g}: aeroservo aero FILE --mach {found.mach:g}"))
    for key, value in found.data.items():
        if key == "surface" and folder is not None:
            value = [s | {"section": [_near(q, folder) for q in s["section"]]} for s in value]
        document.add(key, tomlkit.item(value))
    return tomlkit.dumps(document)


def _near(section: dict[str, object], folder: Path) -> dict[str, object]:
    """The section with its airfoil's file as seen from the model file."""
    path = Path(str(section["airfoil"]))
    if not path.suffix or not path.is_file():
        return section
    try:
        return section | {"airfoil": Path(os.path.relpath(path, folder)).as_posix()}
    except ValueError:  # another drive
        return section | {"airfoil": path.resolve().as_posix()}
