"""The text of a model file, or why it is none."""

from __future__ import annotations

import stat
from pathlib import Path

from aeroservo.aircraft.file_errors import ModelFileError

#: Largest model file read. [byte]
LARGEST = 10_000_000


def file_text(path: Path) -> str:
    """Text of a model file, if it is one.

    Parameters
    ----------
    path : Path
        Of the file.

    Returns
    -------
    text : str
        With line ends of one kind.

    Raises
    ------
    ModelFileError
        If it cannot be read, is no ordinary file, too large, binary, empty, or not UTF-8.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> from aeroservo.aircraft.files import model_path
    >>> file_text(model_path("goland")).splitlines()[0][:17]
    '# The Goland wing'
    """
    kind, content = 0, b""
    try:
        kind = path.stat().st_mode
        if stat.S_ISREG(kind):
            with open(path, "rb") as file:
                content = file.read(LARGEST + 1)
    except PermissionError:
        raise ModelFileError(f"{path}: no permission to read it") from None
    except (OSError, ValueError) as error:
        raise ModelFileError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if stat.S_ISDIR(kind):
        raise ModelFileError(f"{path}: is a folder; give a model file (TOML)")
    if not stat.S_ISREG(kind):
        raise ModelFileError(f"{path}: is not an ordinary file")
    if len(content) > LARGEST:
        raise ModelFileError(f"{path}: is larger than {LARGEST / 1e6:.0f} MB, the most that a model file may have")
    if b"\0" in content:
        raise ModelFileError(f"{path}: is a binary file; a model file is text (TOML)")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ModelFileError(f"{path}: is not text in UTF-8; a model file is text (TOML)") from None
    if not text.strip():
        raise ModelFileError(f"{path}: is empty: start from a preset with 'aeroservo new PRESET FILE'")
    return text.replace("\r\n", "\n")
