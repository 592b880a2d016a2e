"""The turbulence of a run, made piece by piece: one frozen field that every gust zone flies through in its turn.

Zones that lie aft of one another meet the same field later, by the time that the aircraft takes for the way between
them; between samples the field is the cubic through four of them, which at a step of 1 ms keeps 0.99997 of the
amplitude at 30 Hz. Along a changing flight the filters follow airspeed and altitude, and are held for 0.1 s: their
states' covariance depends on neither, so the variance stays exact.
"""

from __future__ import annotations

import math

import numpy as np

from aeroservo.datatypes import Array
from aeroservo.simulate import _kernels
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.profiles import Profile

FOLLOWED = 0.1
"""Time for which a filter is held along a changing flight. [s]"""


class TurbulenceStream:
    """Turbulence at the gust zones, going on where the last piece ended.

    Attributes
    ----------
    weather : Gustiness
        What it is.
    profile : Profile
        The flight.
    dt : float
        Base step. [s]
    reach : ndarray, shape (n_zones,)
        Distance of each zone aft of the foremost. [m]
    """

    def __init__(
        self, weather: Gustiness, profile: Profile, dt: float, offsets: Array, draw: np.random.Generator
    ) -> None:
        self.weather, self.profile, self.dt, self.draw = weather, profile, dt, draw
        self.reach = np.asarray(offsets) - np.min(offsets, initial=np.inf) if len(offsets) else np.zeros(0)
        self.apart = bool(np.any(self.reach))
        self.state: Array | None = None
        self.past = np.zeros(0)
        self.held_noise, self.repeat = 0.0, 1
        if weather.noise_step is not None:
            self.repeat = max(1, round(weather.noise_step / dt))

    def at(self, t: Array) -> Array:
        """Gust velocities, up, at the next base steps t (n,), shape (n, n_zones). [m/s]"""
        if not self.apart:
            return np.repeat(self._samples(t)[:, None], len(self.reach), axis=1)
        late = np.stack([self._late(t, reach) for reach in self.reach], axis=1)
        if not len(self.past):
            slowest = float(self.profile.V.min())
            ahead = math.ceil(float(self.reach.max()) / slowest / self.dt) + 4
            self.past = self._samples(t[0] + self.dt * np.arange(-ahead, 0))
        known = np.concatenate([self.past, self._samples(t)])
        place = len(self.past) + np.arange(len(t))[:, None] - 1.0 - late / self.dt  # all a step late: the cubic's room
        self.past = known[len(known) - len(self.past) :]
        i = np.clip(np.floor(place).astype(int), 1, len(known) - 3)
        f = place - i
        return np.asarray(
            known[i - 1] * (-f * (f - 1.0) * (f - 2.0) / 6.0)
            + known[i] * ((f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0)
            + known[i + 1] * (-(f + 1.0) * f * (f - 2.0) / 2.0)
            + known[i + 2] * ((f + 1.0) * f * (f - 1.0) / 6.0)
        )

    def _late(self, t: Array, reach: float) -> Array:
        """Time in which the aircraft has flown the last `reach` metres; before the start it flew as at the start."""
        here = self.profile.distance(t)
        late = reach / self.profile.speed(t)
        for _ in range(4):  # Newton: quadratic, from a start that is right for a constant airspeed
            late = late + (reach - here + self.profile.distance(t - late)) / self.profile.speed(t - late)
        return np.asarray(late)

    def _samples(self, t: Array) -> Array:
        """The next samples of the field where the foremost zone is, at base steps t (n,)."""
        hold = max(1, round(FOLLOWED / self.dt)) if self.profile.moving else len(t)
        at = np.maximum(t[::hold], 0.0)
        altitude = np.zeros(len(at))
        if self.profile.altitude is not None:
            altitude = np.interp(at, self.profile.t, self.profile.altitude)
        noise = self.weather.filters(self.profile.condition(at), altitude, self.dt)
        if self.state is None:
            value, vector = np.linalg.eigh(noise.P[0])
            root = vector * np.sqrt(np.maximum(value, 0.0))
            self.state = root @ self.draw.standard_normal(len(root))
            if self.weather.noise_step is not None:
                self.state[:] = 0.0
        out, n = np.zeros(len(t)), len(self.state)
        drive, Ld = self.draw.standard_normal((len(t), n)), noise.Ld
        if self.weather.noise_step is not None:
            drive, Ld = self._held(t, drive), self.weather.held_drive(self.profile.condition(at), altitude, self.dt)
        Ad, Ld, C = (np.ascontiguousarray(x) for x in (noise.Ad, Ld, noise.C))
        _kernels.coloured(Ad, Ld, C, hold, 0, self.state, drive, out)
        return out

    def _held(self, t: Array, drive: Array) -> Array:
        """White noise of variance 1/step held over the noise step, in the first column."""
        out = np.zeros_like(drive)
        for k, step in enumerate(np.round(t / self.dt).astype(int)):
            if step % self.repeat == 0:
                self.held_noise = float(drive[k, 0]) / math.sqrt(self.repeat * self.dt)
            out[k, 0] = self.held_noise
        return out
