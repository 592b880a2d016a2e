"""The state of a run: what changes while the compiled engine steps it, piece by piece."""

from __future__ import annotations

import numpy as np

from aeroservo.control.controller import Controller
from aeroservo.datatypes import Array, LinearSystem
from aeroservo.simulate import _kernels
from aeroservo.simulate.disturbances import CosineGust, SharpGust
from aeroservo.simulate.scenario import Prepared, start_state
from aeroservo.simulate.stream import TurbulenceStream


class RunState:
    """Everything that changes during a run; `advance` computes one piece of it.

    Attributes
    ----------
    x : ndarray, shape (n_x,)
        State. [SI]
    statistics : ndarray, shape (4, n_y)
        Largest magnitude, sum, sum of squares and count of each output. [unit of each]
    """

    def __init__(self, prepared: Prepared, seed: int, *, initial: Array | None = None) -> None:
        p = self.p = prepared
        s, c = p.stepper, p.scenario.controller
        n_s, n_y = s.sizes[2], s.sizes[4]
        self.x = s.equilibrium + (start_state(s, p.scenario) if initial is None else initial)
        self.memory = np.zeros(len(s.elements.kinds))
        self.statistics = np.zeros((4, n_y))
        turbulent, sensors = np.random.SeedSequence(seed).spawn(2)
        self.turbulent, self.sensors = np.random.default_rng(turbulent), np.random.default_rng(sensors)
        weather = p.scenario.turbulence
        self.stream = None
        if weather is not None:
            self.stream = TurbulenceStream(weather, p.scenario.profile, p.dt, s.offsets, self.turbulent)
        sampled = c is not None and c.dt_s is not None
        self.sampled = c if sampled else None
        n_in, n_out = (len(c.inputs), len(c.outputs)) if c is not None and sampled else (0, 0)
        n_c = c.A.shape[-1] if c is not None and sampled else 0
        self.ctrl_sizes = (n_c, n_in, n_out)
        self.ctrl = np.zeros((1, n_c + n_out, n_c + n_in + n_out))
        self.rows, self.delays = np.zeros(n_in, np.int64), np.zeros(n_in, np.int64)
        self.noise, self.quanta = np.zeros(n_in), np.zeros(n_in)
        self.limits, self.map = np.zeros(n_out), np.zeros(n_out, np.int64)
        if self.sampled is not None:
            self._controller(self.sampled)
        self.xc, self.latest = np.zeros(n_c), np.zeros(n_out)
        self.ring = np.zeros((int(self.delays.max(initial=0)) + 1, max(n_in, 1)))
        self.queue = np.zeros((p.computing + 1, max(n_out, 1)))
        self._adaptation()
        self.pipe_delays = np.round(s.delays_s / p.dt).astype(np.int64)
        self.pipe = np.zeros((int(self.pipe_delays.max(initial=0)) + 1, max(n_s // 2, 1)))
        self.commands = np.zeros(n_s)
        model = s.model
        limits = {} if isinstance(model, LinearSystem) else {v.mode: v.largest for v in model.limits}
        where = [] if isinstance(model, LinearSystem) else [model.modes.names.index(name) for name in limits]
        self.limit_rows, self.limit_values = np.array(where, dtype=np.int64), np.array([*limits.values()], dtype=float)

    def _controller(self, c: Controller) -> None:
        """Matrices, rows, delays and noise of a sampled controller."""
        s, dt = self.p.stepper, self.p.dt
        model = s.model
        sensors = () if isinstance(model, LinearSystem) else model.sensors
        by_name = {name: sensor for sensor in sensors for name in (sensor.name, sensor.channel)}
        for i, name in enumerate(c.inputs):
            sensor = by_name.get(name)
            channel = name if sensor is None else sensor.channel
            if channel not in s.outputs:
                raise ValueError(
                    f"the controller reads {name!r}, which is no channel; channels: {', '.join(s.outputs)}"
                )
            self.rows[i] = s.outputs.index(channel)
            if sensor is not None:
                self.delays[i] = round(sensor.delay_s / dt)
                self.noise[i], self.quanta[i] = sensor.noise, sensor.quantum
        for i, name in enumerate(c.outputs):
            targets = [command for command in s.commands if name in (command, command.replace("_command_", "_"))]
            if not targets:
                raise ValueError(
                    f"the controller drives {name!r}, which is no command; commands: {', '.join(s.commands)}"
                )
            self.map[i] = s.commands.index(targets[0])
        self.limits = np.array(c.limits)
        n_out = len(c.outputs)
        above = np.concatenate([c.A, c.B, c.windup], axis=2)
        below = np.concatenate([c.C, c.D, np.zeros((len(c.pressures), n_out, n_out))], axis=2)
        self.ctrl = np.ascontiguousarray(np.concatenate([above, below], axis=1))

    def _adaptation(self) -> None:
        """State of the identification, empty where nothing adapts; `adapted` collects what it said at each sample."""
        a = self.p.scenario.adaptation
        self.adapted: list[Array] = []
        self.gain = np.array([1.0, 0.0])
        if a is None or self.sampled is None:
            none = np.zeros((0, 0))
            self.adaptive = (np.zeros((1, 0, 0)), none, np.zeros(11), np.zeros((2, 0, 0)), np.zeros((1, 0, 0)),
                             np.zeros(0, np.bool_), none)  # fmt: skip
            self.fx, self.root, self.theta, self.spread = np.zeros(0), none, none.copy(), np.zeros(1)
            self.block, self.pile = none.copy(), np.zeros((0, 0, 0))
            return
        n, m = a.start.shape
        watch = np.ascontiguousarray(
            np.concatenate([np.concatenate([a.watch.A, a.watch.B], 2), np.concatenate([a.watch.C, a.watch.D], 2)], 1)
        )
        bounds = np.stack([a.lower, a.upper])
        self.adaptive = (
            watch,
            np.array(a.force),
            a.numbers,
            bounds,
            np.array(a.shares),
            np.array(a.scaled),
            np.array(a.dither),
        )
        self.fx, self.theta, self.spread = np.zeros(a.watch.A.shape[-1]), np.array(a.start), np.zeros(m + 1)
        self.block, self.pile = np.zeros((n, m)), np.zeros((m, n, n))
        self.root = np.sqrt(a.numbers[1] / n) * np.eye(n)

    def advance(
        self, start: int, n: int, every: int, record: Array, trace: Array, *, substeps: int | None = None
    ) -> tuple[int, int, int, int]:
        """Compute `n` base steps from step `start`: code, steps done, records written, row of a limit left."""
        p = self.p
        s, profile = p.stepper, p.scenario.profile
        t = p.dt * np.arange(start, start + n + 1)
        knots = p.knots
        if not knots.size:
            count = -(-n // p.per_knot) + 1
            knots = s.rows(profile.condition(p.dt * (start + p.per_knot * np.arange(count))))
        cosines = [g for g in p.scenario.gusts if isinstance(g, CosineGust)]
        pulses = [[g.amplitude, float(profile.distance(g.start)), g.length] for g in cosines]
        weights, noise, first = self._samples(start, n)
        adapted = np.zeros((len(weights), 2 * self.theta.size + 2) if self.theta.size else (0, 0))
        self.adapted.append(adapted)
        return _kernels.run(
            knots, p.per_knot, s.sizes, s.elements.kinds, s.elements.parameters, self.memory, s.stops, p.exact,
            substeps or p.substeps, p.dt, start, n,
            self.x, self._held(t, n), profile.distance(t), profile.speed(t), np.array(pulses).reshape(-1, 3), s.offsets,
            self.external(t[:-1]),
            self.ctrl, self.ctrl_sizes, weights, self.rows, self.delays, self.quanta, noise, self.limits, self.map,
            p.period, p.computing, first, self.xc, self.ring, self.latest, self.queue, self.pipe, self.pipe_delays,
            s.gains, s.command_limits, self.commands,
            *self.adaptive, self.gain, self.fx, self.root, self.theta, self.spread, self.block, self.pile, adapted,
            self.limit_rows, self.limit_values, self.statistics, every, record, trace,
        )  # fmt: skip

    def _samples(self, start: int, n: int) -> tuple[Array, Array, int]:
        """Schedule weights and noise of the controller's samples in a piece, and the number of the first one."""
        if self.sampled is None:
            return np.zeros((0, 2)), np.zeros((0, 0)), 0
        p = self.p
        first = -(-start // p.period)
        count = max(0, -(-(start + n) // p.period) - first)
        at = p.dt * p.period * (first + np.arange(count))
        weights = self.sampled.blend(np.atleast_1d(p.scenario.profile.condition(at).q)) if count else np.zeros((0, 2))
        noise = np.zeros((count, len(self.noise)))
        if np.any(self.noise):
            noise = self.sensors.standard_normal((count, len(self.noise))) * self.noise
        return weights, noise, first

    def external(self, t: Array) -> Array:
        """Doublets on the base steps.

        Parameters
        ----------
        t : ndarray, shape (n,)
            Times of the base steps. [s]

        Returns
        -------
        command : ndarray, shape (n, n_u)
            Added to the commands. [rad]

        Raises
        ------
        ValueError
            If a doublet drives a command that does not exist.
        """
        s = self.p.stepper
        out = np.zeros((len(t), len(s.commands)))
        for d in self.p.scenario.doublets:
            name = d.command or s.commands[0]
            if name not in s.commands:
                raise ValueError(f"a doublet drives {name!r}, which is no command; commands: {', '.join(s.commands)}")
            begin, middle, end = (round((d.start + f * d.duration) / self.p.dt) for f in (0.0, 0.5, 1.0))
            k = np.round(t / self.p.dt).astype(int)
            out[(k >= begin) & (k < middle), s.commands.index(name)] += d.amplitude
            out[(k >= middle) & (k < end), s.commands.index(name)] -= d.amplitude
        return out

    def _held(self, t: Array, n: int) -> Array:
        """Gusts held over the base steps, shape (n, n_zone)."""
        p, zones = self.p, len(self.p.stepper.offsets)
        held = np.zeros((n, zones))
        way = p.scenario.profile.distance(t[:-1])
        for gust in p.scenario.gusts:
            if isinstance(gust, SharpGust):
                met = float(p.scenario.profile.distance(gust.start)) + p.stepper.offsets
                held += gust.amplitude * (way[:, None] >= met - 1e-9 * np.maximum(1.0, np.abs(met)))
        if self.stream is not None:
            held += self.stream.at(t[:-1])
        return held
