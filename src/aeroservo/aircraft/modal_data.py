"""The user's own modes and air forces, read from `.npz` or `.mat` files: kind `modal`.

Arrays are read by name and checked; nothing in a file is ever executed (pickled objects are refused). The matrices are
any consistent set: the unit of each follows its generalised coordinate.
"""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.datatypes import frozen

#: Largest data file read, unpacked. [byte]
LARGEST = 4 * 1024**3
_NEEDED = ("M", "K", "k", "mach", "Q", "b_m", "mode_names", "input_names")
_OPTIONAL = ("D", "phi", "grid", "M_control")


@dataclass(frozen=True, kw_only=True, eq=False)
class ModalData:
    """A structure in the user's modes, and its air forces at samples.

    Attributes
    ----------
    M, D, K : ndarray, shape (n, n)
        Generalised mass, viscous damping (zero if the file has none) and stiffness. [SI]
    k : ndarray, shape (n_k,)
        Reduced frequencies omega b/V, ascending. [-]
    mach : ndarray, shape (n_mach,)
        Mach numbers, ascending. [-]
    Q : complex ndarray, shape (n_mach, n_k, n, n_in)
        Force = + q_bar Q at e^(+i omega t). [SI]
    b_m : float
        Reference semi-chord. [m]
    mode_names, input_names : tuple of str, lengths n and n_in
        The first n inputs are the modes.
    phi : ndarray, shape (n_grid, 6, n), optional
        Displacement and rotation of the grid points per unit of each mode. [m, rad per unit]
    grid : ndarray, shape (n_grid, 3), optional
        Grid points in geometry axes. [m]
    M_control : ndarray, shape (n, n_u), optional
        Inertia coupling to the control inputs. [SI]
    """

    M: NDArray[Any]
    D: NDArray[Any]
    K: NDArray[Any]
    k: NDArray[Any]
    mach: NDArray[Any]
    Q: NDArray[Any]
    b_m: float
    mode_names: tuple[str, ...]
    input_names: tuple[str, ...]
    phi: NDArray[Any] | None = None
    grid: NDArray[Any] | None = None
    M_control: NDArray[Any] | None = None


def read_modal_data(path: Path) -> ModalData:
    """Read and check the arrays of a data file.

    Parameters
    ----------
    path : Path
        A `.npz` file of numpy, or a `.mat` file of Matlab up to version 7.

    Returns
    -------
    data : ModalData
        With locked arrays. [SI]

    Raises
    ------
    ValueError
        If the file is missing, unreadable, holds pickled objects, lacks an array or has one of the wrong shape.

    References
    ----------
    Project convention: contract.md, kind "modal".

    Examples
    --------
    >>> try:
    ...     read_modal_data(Path("nowhere.npz"))
    ... except ValueError as error:
    ...     print(error)
    nowhere.npz: no such file
    """
    if not path.is_file():
        raise ValueError(f"{path}: {'is not a file' if path.exists() else 'no such file'}")
    try:
        found = _from_npz(path) if path.suffix.lower() == ".npz" else _from_mat(path)
    except PermissionError:
        raise ValueError(f"{path}: no permission to read it") from None
    except MemoryError:
        raise ValueError(f"{path}: the arrays do not fit into memory") from None
    try:
        return _checked(found)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _from_npz(path: Path) -> dict[str, Any]:
    """The arrays of a .npz file that have a name we know."""
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(member.file_size for member in archive.infolist())
        if size > LARGEST:
            raise ValueError(f"{path}: unpacks to {size / 1e9:.1f} GB; the limit is {LARGEST / 1e9:.1f} GB")
        with np.load(path, allow_pickle=False) as archive:
            names = [name for name in (*_NEEDED, *_OPTIONAL) if name in archive.files]
            return {name: _unpickled(archive, name, path) for name in names}
    except (zipfile.BadZipFile, EOFError, OSError, KeyError) as error:
        if isinstance(error, PermissionError):
            raise
        raise ValueError(f"{path}: is not a readable .npz file ({error})") from None


def _unpickled(archive: Any, name: str, path: Path) -> Any:
    try:
        return archive[name]
    except ValueError as error:
        hint = "save names as np.array([...], dtype=str)" if name.endswith("_names") else "save it as numbers"
        raise ValueError(
            f"{path}: array {name!r} is refused, it holds pickled objects or is damaged ({hint})"
        ) from error


def _from_mat(path: Path) -> dict[str, Any]:
    """The arrays of a .mat file that have a name we know; Matlab's shapes and cells made plain."""
    from scipy.io import loadmat

    if path.stat().st_size > LARGEST:
        raise ValueError(f"{path}: is {path.stat().st_size / 1e9:.1f} GB; the limit is {LARGEST / 1e9:.1f} GB")
    try:
        found = loadmat(path, variable_names=[*_NEEDED, *_OPTIONAL], struct_as_record=True)
    except NotImplementedError:
        raise ValueError(f"{path}: is a Matlab 7.3 file; save it with save(..., '-v7')") from None
    except (PermissionError, MemoryError):
        raise
    except Exception as error:  # scipy.io raises many kinds for a damaged file
        raise ValueError(f"{path}: is not a readable .mat file ({error})") from None
    arrays: dict[str, Any] = {name: found[name] for name in (*_NEEDED, *_OPTIONAL) if name in found}
    for name in ("k", "mach", "b_m"):
        if name in arrays:
            arrays[name] = np.ravel(arrays[name])
    for name in ("mode_names", "input_names"):
        if name in arrays:
            arrays[name] = _matlab_names(arrays[name])
    return _with_trailing_axes(arrays)


def _matlab_names(cells: Any) -> NDArray[Any]:
    """Names from a cell array of strings or a character matrix."""
    return np.array([str(np.ravel(cell)[0]).rstrip() if np.size(cell) else "" for cell in np.ravel(cells)], dtype=str)


def _with_trailing_axes(arrays: dict[str, Any]) -> dict[str, Any]:
    """Matlab drops trailing axes of length one: put them back where a name tells their number."""
    for name, axes in (("Q", 4), ("phi", 3)):
        if name in arrays:
            shape = arrays[name].shape
            arrays[name] = arrays[name].reshape(*shape, *(1,) * max(0, axes - len(shape)))
    return arrays


def _checked(found: dict[str, Any]) -> ModalData:
    """Every array present, of its shape, of finite numbers."""
    missing = [name for name in _NEEDED if name not in found]
    if missing:
        raise ValueError(f"lacks the array(s) {', '.join(missing)}; needed are {', '.join(_NEEDED)}")
    mode_names, input_names = (_names(found[name], name) for name in ("mode_names", "input_names"))
    n, n_in = len(mode_names), len(input_names)
    if n < 1 or input_names[:n] != mode_names:
        raise ValueError(f"the first {n} input_names must be the mode_names {mode_names}, got {input_names[:n]}")
    if len(set(input_names)) != n_in:
        raise ValueError(f"input_names must differ, got {input_names}")
    k, mach = (_numbers(np.atleast_1d(found[name]), name, (None,)) for name in ("k", "mach"))
    for name, axis in (("k", k), ("mach", mach)):
        if len(axis) == 0 or axis[0] < 0.0 or np.any(np.diff(axis) <= 0.0):
            raise ValueError(
                f"{name} must hold ascending numbers, none negative [-], got {np.array2string(axis, threshold=6)}"
            )
    b_m = _numbers(np.ravel(found["b_m"]), "b_m", (1,))
    if not b_m[0] > 0.0:
        raise ValueError(f"b_m must be positive [m], got {b_m[0]:g}")
    M, K = (_numbers(found[name], name, (n, n)) for name in ("M", "K"))
    D = _numbers(found["D"], "D", (n, n)) if "D" in found else frozen(np.zeros((n, n)))
    if not np.allclose(M, M.T, rtol=1e-6, atol=1e-9 * np.abs(M).max()) or np.linalg.eigvalsh(M).min() <= 0.0:
        raise ValueError("M must be symmetric and positive definite")
    phi, grid, M_control = (
        _numbers(found[name], name, shape) if name in found else None
        for name, shape in (("phi", (None, 6, n)), ("grid", (None, 3)), ("M_control", (n, None)))
    )
    if (phi is None) != (grid is None) or (phi is not None and grid is not None and len(phi) != len(grid)):
        raise ValueError("phi (n_grid, 6, n) and grid (n_grid, 3) must be given together, with the same n_grid")
    return ModalData(
        M=M,
        D=D,
        K=K,
        k=k,
        mach=mach,
        Q=_numbers(found["Q"], "Q", (len(mach), len(k), n, n_in), dtype=complex),
        b_m=float(b_m[0]),
        mode_names=mode_names,
        input_names=input_names,
        phi=phi,
        grid=grid,
        M_control=M_control,
    )


def _numbers(value: Any, name: str, shape: tuple[int | None, ...], dtype: type = float) -> NDArray[Any]:
    """A locked array of finite numbers of a shape, None for a free axis."""
    array = np.asarray(value)
    if array.dtype.kind not in "iufc":
        raise ValueError(f"{name} must hold numbers, got {array.dtype}")
    if array.dtype.kind == "c" and dtype is float:
        if np.any(array.imag):
            raise ValueError(f"{name} must hold real numbers, got complex ones")
        array = array.real
    if len(shape) != array.ndim or any(want not in (None, got) for want, got in zip(shape, array.shape)):
        text = ", ".join("any" if want is None else str(want) for want in shape)
        raise ValueError(f"{name} must have shape ({text}), got {array.shape}")
    return frozen(array, dtype=dtype, name=name)


def _names(value: Any, name: str) -> tuple[str, ...]:
    """Names as a tuple of printable strings."""
    array = np.asarray(value)
    if array.dtype.kind not in "US" or array.ndim > 1:
        raise ValueError(f"{name} must be a list of strings, got {array.dtype} of shape {array.shape}")
    names = tuple(x.decode("utf-8", "replace") if isinstance(x, bytes) else str(x) for x in np.atleast_1d(array))
    for text in names:
        if not text or not text.isprintable() or len(text) > 200:
            raise ValueError(f"{name} must hold printable names of 1 to 200 characters, got {text[:40]!r}")
    return names
