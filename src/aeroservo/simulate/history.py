"""Time histories: named channels with units, to and from files."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from aeroservo.datatypes import Array, frozen

if TYPE_CHECKING:
    import xarray

UNITS = {
    "rad_s2": "rad/s^2", "m_s2": "m/s^2", "rad_s": "rad/s", "m_s": "m/s", "rad": "rad", "deg": "deg", "1_s": "1/s",
    "Pa": "Pa", "Hz": "Hz", "m": "m", "s": "s", "N": "N",
}  # fmt: skip
"""Unit that each suffix of a channel name stands for."""


def unit_of(name: str) -> str:
    """Unit of a channel by the suffix of its name, longest first.

    Parameters
    ----------
    name : str
        Channel.

    Returns
    -------
    unit : str
        "" where no suffix is known.
    """
    return next((unit for suffix, unit in UNITS.items() if name.endswith("_" + suffix)), "")


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happened during a run.

    Attributes
    ----------
    t : float
        When. [s]
    text : str
        What.
    """

    t: float
    text: str


@dataclass(frozen=True, kw_only=True, eq=False)
class TimeHistory:
    """Channels sampled at the same times.

    Attributes
    ----------
    t : ndarray, shape (n_t,)
        Times, ascending. [s]
    data : ndarray, shape (n_t, n_channel)
        One column for each channel. [unit of the channel]
    channels : tuple of str
        Names; the unit is the suffix.
    units : tuple of str
        Units in words, by default from the names.
    events : tuple of Event
        What happened.
    """

    t: Array
    data: Array
    channels: tuple[str, ...]
    units: tuple[str, ...] = ()
    events: tuple[Event, ...] = ()

    def __post_init__(self) -> None:
        """Lock the arrays and check them."""
        object.__setattr__(self, "t", frozen(self.t, ndim=1, name="t"))
        object.__setattr__(self, "data", frozen(self.data, ndim=2, name="data"))
        if self.data.shape != (len(self.t), len(self.channels)):
            raise ValueError(
                f"data must have shape (times, channels) = ({len(self.t)}, {len(self.channels)}), got {self.data.shape}"
            )
        if np.any(np.diff(self.t) <= 0.0):
            raise ValueError("times t must ascend [s]")
        if len(set(self.channels)) != len(self.channels):
            raise ValueError(f"channel names must differ, got {self.channels}")
        object.__setattr__(self, "units", self.units or tuple(unit_of(name) for name in self.channels))
        if len(self.units) != len(self.channels):
            raise ValueError(f"units must name one unit for each of {len(self.channels)} channels")

    def __getitem__(self, channel: str) -> Array:
        """One channel by its name, shape (n_t,). [unit of the channel]"""
        if channel not in self.channels:
            raise ValueError(f"no channel {channel!r}; there are {', '.join(self.channels)}")
        return np.asarray(self.data[:, self.channels.index(channel)])

    def between(self, start: float, end: float) -> TimeHistory:
        """The part from `start` to `end`, both included [s]; same channels and units, events inside it."""
        keep = (self.t >= start) & (self.t <= end)
        events = tuple(e for e in self.events if start <= e.t <= end)
        return TimeHistory(
            t=self.t[keep], data=self.data[keep], channels=self.channels, units=self.units, events=events
        )

    def to_xarray(self) -> xarray.Dataset:
        """As an xarray Dataset with unit attributes.

        Returns
        -------
        dataset : xarray.Dataset
            One variable for each channel, along `time`. [unit of the channel]

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        try:
            import xarray
        except ImportError:
            raise ImportError("to_xarray needs xarray: pip install xarray") from None
        variables = {
            name: ("time", self.data[:, j], {"units": unit})
            for j, (name, unit) in enumerate(zip(self.channels, self.units))
        }
        return xarray.Dataset(variables, coords={"time": ("time", self.t, {"units": "s"})})


def history_bytes(history: TimeHistory, ending: str) -> bytes:
    """The content of a file with a history.

    Parameters
    ----------
    history : TimeHistory
        What.
    ending : {".nc", ".csv", ".mat"}
        NetCDF 3, CSV (first row the names, first column `time_s`), or MATLAB 5. [-]

    Returns
    -------
    content : bytes
        To be written as it is.

    Raises
    ------
    ValueError
        If the ending is another.
    """
    ending = ending.lower()
    if ending == ".csv":
        return _csv(history)
    if ending == ".mat":
        return _mat(history)
    if ending == ".nc":
        return _netcdf(history)
    raise ValueError(f"a time history is written as .nc, .csv or .mat, not {ending!r}")


def write_history(path: str | Path, history: TimeHistory) -> None:
    """Write a history to a file, whole or not at all.

    Parameters
    ----------
    path : str or Path
        Ending .nc, .csv or .mat.
    history : TimeHistory
        What.

    Raises
    ------
    ValueError
        If the ending is another.
    """
    from aeroservo.aircraft.files import write_whole

    path = Path(path)
    write_whole(path, history_bytes(history, path.suffix))


def read_history(path: str | Path) -> TimeHistory:
    """A history from a CSV (also of a test) or a NetCDF file of ours.

    The first row of a CSV names the channels; its first column is the time in seconds. Lines that begin with # are
    skipped.

    Parameters
    ----------
    path : str or Path
        Ending .csv or .nc.

    Returns
    -------
    history : TimeHistory
        Channels as named. [unit of the channel]

    Raises
    ------
    ValueError
        If it cannot be read, a number is missing or the times do not ascend: the message names file and line.
    """
    path = Path(path)
    try:
        if path.suffix.lower() == ".nc":
            return _read_netcdf(path)
        if path.suffix.lower() != ".csv":
            raise ValueError(f"{path}: a time history is read from .csv or .nc")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not text in UTF-8") from None
    return _read_csv(text, path)


def _csv(history: TimeHistory) -> bytes:
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["time_s", *history.channels])
    for t, row in zip(history.t.tolist(), history.data.tolist()):
        writer.writerow([repr(t), *map(repr, row)])
    return out.getvalue().encode()


def _mat(history: TimeHistory) -> bytes:
    from scipy.io import savemat

    content = {"time_s": history.t} | {
        _matlab_name(name): history.data[:, j] for j, name in enumerate(history.channels)
    }
    content["channels"] = np.array(history.channels, dtype=object)
    content["units"] = np.array(history.units, dtype=object)
    file = io.BytesIO()
    savemat(file, content, oned_as="column")
    return file.getvalue()


def _matlab_name(name: str) -> str:
    """A name that MATLAB takes: letters, digits, underscores, at most 31."""
    plain = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in name)
    return (plain if plain[:1].isalpha() else f"c_{plain}")[:31]


def _netcdf(history: TimeHistory) -> bytes:
    from scipy.io import netcdf_file

    file = io.BytesIO()
    nc = netcdf_file(file, "w", version=2)
    nc.createDimension("time", len(history.t))
    variables = [("time", history.t, "s")]
    variables += [
        (name, history.data[:, j], unit) for j, (name, unit) in enumerate(zip(history.channels, history.units))
    ]
    for name, values, unit in variables:
        variable = nc.createVariable(name, "d", ("time",))
        variable[:] = values
        variable.units = unit or "1"
    nc.Conventions = "CF-1.8"
    nc.events = "\n".join(f"{event.t!r} {event.text}" for event in history.events) or " "
    nc.flush()
    content = file.getvalue()
    nc.close()
    return content


def _read_netcdf(path: Path) -> TimeHistory:
    from scipy.io import netcdf_file

    try:
        with netcdf_file(str(path), "r", mmap=False) as nc:
            names = tuple(name for name in nc.variables if name != "time")
            data = np.stack([nc.variables[name][:] for name in names], axis=1)
            units = tuple(nc.variables[name].units.decode() for name in names)
            lines = nc.events.decode().strip().splitlines()
            t = nc.variables["time"][:].copy()
    except (TypeError, KeyError, AttributeError, IndexError) as error:
        raise ValueError(f"{path}: is no time history in NetCDF: {error}") from None
    events = tuple(Event(t=float(line.split(" ", 1)[0]), text=line.split(" ", 1)[1]) for line in lines)
    return TimeHistory(t=t, data=data, channels=names, units=tuple("" if u == "1" else u for u in units), events=events)


def _read_csv(text: str, path: Path) -> TimeHistory:
    numbered = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    rows = [(i, next(csv.reader([line]))) for i, line in numbered]
    if len(rows) < 3:
        raise ValueError(f"{path}: needs a row of names and two or more rows of numbers")
    names, values = tuple(name.strip() for name in rows[0][1][1:]), []
    for i, row in rows[1:]:
        try:
            numbers = [float(x) for x in row]
        except ValueError:
            raise ValueError(f"{path}, line {i}: holds something that is not a number: {row!r:.100}") from None
        if len(numbers) != len(names) + 1 or not all(map(math.isfinite, numbers)):
            raise ValueError(f"{path}, line {i}: must hold {len(names) + 1} finite numbers, got {row!r:.100}")
        values.append(numbers)
    data = np.array(values)
    try:
        return TimeHistory(t=data[:, 0], data=data[:, 1:], channels=names)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def even(history: TimeHistory, channel: str) -> tuple[Array, float]:
    """A channel on an even grid, as identification needs it.

    Parameters
    ----------
    history : TimeHistory
        With times that are even to 1e-6 of a step, or not.
    channel : str
        Which.

    Returns
    -------
    y, dt : ndarray of shape (n_t,), float
        Values (interpolated where the grid was uneven) and step. [unit of the channel, s]
    """
    y, t = history[channel], history.t
    dt = float((t[-1] - t[0]) / (len(t) - 1))
    regular = t[0] + dt * np.arange(len(t))
    if np.abs(t - regular).max() > 1e-6 * dt:
        y = np.asarray(np.interp(regular, t, y))
    return np.asarray(y), dt
