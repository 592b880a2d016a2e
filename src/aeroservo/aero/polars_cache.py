"""Results on disk, keyed by what they were computed from, written so that no reader ever sees half a file."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np


def cache_folder() -> Path:
    """Folder of the cache.

    Returns
    -------
    folder : Path
        ``$AEROSERVO_CACHE``, else ``$XDG_CACHE_HOME/aeroservo``, else ``~/.cache/aeroservo``.

    References
    ----------
    XDG Base Directory Specification, 2021, section "Environment variables".

    Examples
    --------
    >>> cache_folder().name != ""
    True
    """
    chosen = os.environ.get("AEROSERVO_CACHE")
    if chosen:
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "aeroservo"


def cached_array(
    parts: Sequence[object], compute: Callable[[], np.ndarray], *, folder: Path | None = None
) -> np.ndarray:
    """An array from the cache, or computed and then kept.

    Parameters
    ----------
    parts : sequence
        Everything that the result depends on: strings, numbers, arrays. The key is a hash of their content.
    compute : callable
        Gives the array when it is not there.
    folder : Path, optional
        Folder instead of `cache_folder`.

    Returns
    -------
    values : ndarray, shape (...)
        The array, in the unit that `compute` gives. [any]

    References
    ----------
    Project convention: write a temporary file in the same folder, then rename it: a rename is atomic.

    Examples
    --------
    >>> import tempfile
    >>> place = Path(tempfile.mkdtemp())
    >>> float(cached_array(["a", 1], lambda: np.array(2.0), folder=place))
    2.0
    >>> float(cached_array(["a", 1], lambda: np.array(3.0), folder=place))
    2.0
    """
    folder = cache_folder() if folder is None else folder
    path = folder / f"{content_key(parts)}.npy"
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except (OSError, ValueError, EOFError):
        pass  # absent, or unreadable: compute it anew
    values = np.asarray(compute())
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, suffix=".part")
    except OSError:
        return values  # no place to keep it: the result is still right
    try:
        with os.fdopen(handle, "wb") as file:
            np.save(file, values, allow_pickle=False)
        os.replace(name, path)
    except OSError:
        Path(name).unlink(missing_ok=True)
    return values


def content_key(parts: Sequence[object]) -> str:
    """Hash of strings, numbers and arrays.

    Parameters
    ----------
    parts : sequence
        Strings, numbers, arrays.

    Returns
    -------
    key : str
        40 hexadecimal digits; equal for equal content only.

    References
    ----------
    NIST FIPS 180-4, 2015, section 6.2 (SHA-256, cut).

    Examples
    --------
    >>> content_key(["a", 1.0]) == content_key(["a", 1.0]), content_key(["a"]) == content_key(["b"])
    (True, False)
    """
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            block = f"array {part.dtype} {part.shape}".encode() + np.ascontiguousarray(part).tobytes()
        else:
            block = f"{type(part).__name__} {part!r}".encode()
        digest.update(len(block).to_bytes(8, "little") + block)
    return digest.hexdigest()[:40]
