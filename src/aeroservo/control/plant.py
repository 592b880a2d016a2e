"""The plant that a controller sees: chosen inputs and sensors, at its rate, with actuators and dead times inside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from aeroservo.aeroelastic.linear import displacement_free, linear_system
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem
from aeroservo.servo import Sensor

WHOLE = 1e-9
"""A delay this close to a whole number of samples is one. [sample]"""

LONGEST = 200.0
"""Longest delay that is modelled. [sample]"""


def design_plant(
    model: AeroelasticModel,
    condition: FlightCondition,
    *,
    rate_Hz: float | None = None,
    delay_samples: float = 0.0,
    actuators: bool = True,
    sensors: Sequence[str] | None = None,
    gusts: bool = False,
    keep_free: bool = False,
) -> LinearSystem:
    """State space of a model for the design and analysis of a controller.

    It holds what `linear_system` leaves out: the lag of each sensor that has a bandwidth, the dead times of actuators
    and (sampled only) of sensors. A position that nothing depends on, such as the heave of a free aircraft, is left
    out: no gyro or accelerometer sees it.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        Any shape (...); the plants are a batch.
    rate_Hz : float, optional
        Sample rate of the controller; None is continuous. [Hz]
    delay_samples : float
        Computing delay, whole or fractional. [sample]
    actuators : bool
        Whether actuators are inside.
    sensors : sequence of str, optional
        Names or channels of what is measured, in this order; all outputs if not given.
    gusts : bool
        Whether the gust zones remain inputs, after the controls.
    keep_free : bool
        Keep positions that nothing depends on.

    Returns
    -------
    plant : LinearSystem
        Controls (and gusts) to outputs, continuous or sampled, batched as `condition`. [SI]

    Raises
    ------
    ValueError
        If a sensor is unknown, a rate or delay is out of range, or a continuous plant would need a delay that differs
        between inputs or sits in a sensor.

    References
    ----------
    equations.md, "Control"; K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 3.2.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> plant = design_plant(build(read("bact")), FlightCondition.at(0.0, V=100.0), rate_Hz=200.0, delay_samples=1)
    >>> plant.inputs, plant.dt
    (('elevon_command_rad',), 0.005)
    """
    if rate_Hz is not None and not 0.0 < rate_Hz < math.inf:
        raise ValueError(f"rate_Hz must be positive [Hz] or None, got {rate_Hz}")
    if rate_Hz is None and delay_samples:
        raise ValueError("a delay in samples needs a sample rate: rate_Hz [Hz]")
    system = _lagged(linear_system(model, condition, actuators=actuators), model.sensors)
    controls = tuple(name for name in system.inputs if not name.startswith("gust"))
    dead = {a.control: a.delay_s for a in model.actuators if a.delay_s} if actuators else {}
    delays = [dead.get(name.removesuffix("_rad").removesuffix("_command"), 0.0) for name in controls]
    late = {s.channel: s.delay_s for s in model.sensors if s.delay_s}
    if not keep_free:
        free = np.flatnonzero(displacement_free(model.modes, model.aero))
        system = _without(system, [system.states[i] for i in free])
    wanted = None if sensors is None else tuple(_channel(name, model.sensors, system.outputs) for name in sensors)
    system = chosen(system, inputs=None if gusts else controls, outputs=wanted)
    if rate_Hz is not None:
        ages = np.array([late.get(name, 0.0) for name in system.outputs]) * rate_Hz
        pauses = np.array([delay_samples + d * rate_Hz for d in delays] + [0.0] * (len(system.inputs) - len(controls)))
        return _sampled(system, 1.0 / rate_Hz, pauses, ages)
    if len(set(delays)) > 1 or (any(delays) and gusts) or any(name in late for name in system.outputs):
        raise ValueError(
            "a continuous plant has one dead time, of all its inputs: these actuators or sensors differ; give rate_Hz"
        )
    return replace(system, input_delay_s=delays[0] if delays else 0.0)


def sampled_plant(
    system: LinearSystem,
    dt_s: float,
    *,
    delay_samples: float = 0.0,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
) -> LinearSystem:
    """A system as a sampled controller sees it: held inputs, exact transition, delay states inside.

    A command u[k] computed from the sample at t = k dt acts from t + delay on, held for dt. A fractional delay splits
    the hold. The delay is that asked for plus the system's own `input_delay_s`; inputs named `gust...` are held, not
    delayed. States: those of the system, then `<input>_1_ago`, `<input>_2_ago`, ...

    A sample is taken just before the held command changes, as an accelerometer's converter does and as the simulator
    does: where commands act on an output at once (D is not zero), the sample holds the old one, so that sampled loops
    are never algebraic.

    Parameters
    ----------
    system : LinearSystem
        Continuous, or sampled at `dt_s` already; any batch shape (...).
    dt_s : float
        Sample time. [s]
    delay_samples : float
        Delay of the commands, whole or fractional. [sample]
    inputs, outputs : sequence of str, optional
        Channels to keep, in this order; all if not given.

    Returns
    -------
    plant : LinearSystem
        With `dt` and no `input_delay_s`. [SI]

    Raises
    ------
    ValueError
        If a channel is unknown, the sample time is not positive, the delay is negative or longer than 200 samples,
        or a sampled system comes with another sample time or needs a fractional delay.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 3.2 (systems with time delay);
    C. F. Van Loan, IEEE Trans. Autom. Control 23(3), 1978.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> integrator = LinearSystem(A=[[0.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> plant = sampled_plant(integrator, 0.1, delay_samples=1.5)
    >>> plant.states, plant.A.round(3).tolist()
    (('x', 'u_1_ago', 'u_2_ago'), [[1.0, 0.05, 0.05], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    """
    if not 0.0 < dt_s < math.inf:
        raise ValueError(f"dt_s must be positive [s], got {dt_s}")
    if not 0.0 <= delay_samples < math.inf:
        raise ValueError(f"delay_samples must not be negative [sample], got {delay_samples}")
    system = chosen(system, inputs=inputs, outputs=outputs)
    delay = delay_samples + system.input_delay_s / dt_s
    delays = np.array([0.0 if name.startswith("gust") else delay for name in system.inputs])
    return _sampled(system, dt_s, delays, np.zeros(len(system.outputs)))


def chosen(
    system: LinearSystem, *, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None
) -> LinearSystem:
    """The same system with some of its inputs and outputs, in the order asked for.

    Parameters
    ----------
    system : LinearSystem
        Any batch.
    inputs, outputs : sequence of str, optional
        Channels; all if not given.

    Returns
    -------
    system : LinearSystem
        With these channels. [SI]

    Raises
    ------
    ValueError
        Naming a channel that does not exist, and those that do.

    References
    ----------
    Project convention: channels are chosen by name, never by number.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u", "w"), "outputs": ("y",)}
    >>> two = LinearSystem(A=[[-1.0]], B=[[1.0, 2.0]], C=[[1.0]], D=[[0.0, 0.0]], **names)
    >>> chosen(two, inputs=["w"]).B.tolist()
    [[2.0]]
    """
    inputs = system.inputs if inputs is None else tuple(inputs)
    outputs = system.outputs if outputs is None else tuple(outputs)
    for what, wanted, known in (("input", inputs, system.inputs), ("output", outputs, system.outputs)):
        for name in wanted:
            if name not in known:
                raise ValueError(f"{what} {name!r} does not exist; there are {', '.join(known)}")
        if len(set(wanted)) != len(wanted):
            raise ValueError(f"{what}s must differ, got {', '.join(wanted)}")
    column, row = [system.inputs.index(n) for n in inputs], [system.outputs.index(n) for n in outputs]
    return replace(
        system, B=system.B[..., column], C=system.C[..., row, :], D=system.D[..., row, :][..., column], inputs=inputs,
        outputs=outputs,
    )  # fmt: skip


def _channel(name: str, sensors: tuple[Sensor, ...], outputs: tuple[str, ...]) -> str:
    """Channel of a sensor asked for by its name, or of any output."""
    for sensor in sensors:
        if name in (sensor.name, sensor.channel):
            return sensor.channel
    if name not in outputs:
        raise ValueError(
            f"sensor {name!r} does not exist; sensors: {', '.join(s.name for s in sensors) or 'none'}; "
            f"other outputs: {', '.join(o for o in outputs if o not in [s.channel for s in sensors])}"
        )
    return name


def _lagged(system: LinearSystem, sensors: tuple[Sensor, ...]) -> LinearSystem:
    """With the first-order lag of each sensor that has a bandwidth as a state."""
    for sensor in sensors:
        if sensor.bandwidth is None:
            continue
        row, w, n = system.outputs.index(sensor.channel), sensor.bandwidth, len(system.states)
        batch = system.A.shape[:-2]
        A, B = np.zeros((*batch, n + 1, n + 1)), np.zeros((*batch, n + 1, len(system.inputs)))
        C = np.concatenate([system.C, np.zeros((*batch, len(system.outputs), 1))], axis=-1)
        D = system.D.copy()
        A[..., :n, :n], B[..., :n, :] = system.A, system.B
        A[..., n, :n], B[..., n, :], A[..., n, n] = w * system.C[..., row, :], w * system.D[..., row, :], -w
        C[..., row, :], D[..., row, :] = 0.0, 0.0
        C[..., row, n] = 1.0
        system = replace(system, A=A, B=B, C=C, D=D, states=(*system.states, f"{sensor.channel}_lagged"))
    return system


def _without(system: LinearSystem, states: list[str]) -> LinearSystem:
    """Without states on which nothing depends, and outputs that show them."""
    if not states:
        return system
    keep = [i for i, name in enumerate(system.states) if name not in states]
    gone = [i for i, name in enumerate(system.states) if name in states]
    rows = [i for i in range(len(system.outputs)) if not np.any(system.C[..., i, gone])]
    return replace(
        system, A=system.A[..., keep, :][..., keep], B=system.B[..., keep, :], C=system.C[..., rows, :][..., keep],
        D=system.D[..., rows, :], states=tuple(system.states[i] for i in keep),
        outputs=tuple(system.outputs[i] for i in rows),
    )  # fmt: skip


class _Hold:
    """Transition over a part of a sample with inputs that switch inside it: x(s) = Phi x + old u_old + new u_new."""

    def __init__(self, system: LinearSystem, dt: float, switch: Array) -> None:
        self.A, self.B, self.dt, self.switch = system.A, system.B, dt, switch
        self.discrete = system.dt is not None

    def over(self, part: float) -> tuple[Array, Array, Array]:
        """Phi, old, new over the first `part` of a sample; a switch at 0 has no old input."""
        if self.discrete:
            return self.A, np.zeros_like(self.B), self.B
        Phi = self._step(part)[0]
        old, new = np.zeros_like(self.B), np.zeros_like(self.B)
        for g in set(self.switch.tolist()):
            column = np.flatnonzero(self.switch == g)
            before = self._step(min(part, g))[1][..., column]
            if part > g:
                rest, after = self._step(part - g)
                old[..., column], new[..., column] = rest @ before, after[..., column]
            else:
                old[..., column] = before
        return Phi, old, new

    def _step(self, part: float) -> tuple[Array, Array]:
        """Transition and drive of a held input over a part of a sample, from one exponential."""
        from scipy.linalg import expm

        n, m = self.B.shape[-2:]
        big = np.zeros((*self.A.shape[:-2], n + m, n + m))
        big[..., :n, :n], big[..., :n, n:] = self.A, self.B
        E = expm(big * (part * self.dt))
        return E[..., :n, :n], E[..., :n, n:]


def _sampled(system: LinearSystem, dt: float, delays: Array, ages: Array) -> LinearSystem:
    """Held, delayed inputs and aged outputs; delays and ages in samples, one per channel."""
    if max(delays.max(initial=0.0), ages.max(initial=0.0)) > LONGEST:
        raise ValueError(f"a delay must be at most {LONGEST:g} samples of {dt:g} s, got {max(*delays, *ages):g}")
    _, part = _split(delays)
    if system.dt is not None and (abs(system.dt - dt) > 1e-12 * dt or np.any(part) or np.any(ages)):
        raise ValueError(f"a system sampled at {system.dt:g} s can only be delayed by whole samples of its own")
    return _Sampling(system, dt, delays, ages).system()


class _Sampling:
    """Matrices of a sampled plant: rows over [states, past commands, past samples] and the inputs of now."""

    def __init__(self, system: LinearSystem, dt: float, delays: Array, ages: Array) -> None:
        self.plant, self.dt = system, dt
        self.n, self.n_u, self.batch = len(system.states), len(system.inputs), system.A.shape[:-2]
        self.whole, self.part = _split(delays)
        commanded = np.array([not name.startswith("gust") for name in system.inputs], dtype=bool)
        acts = np.any(system.D != 0.0, axis=tuple(range(system.D.ndim - 1)))
        self.direct = acts & commanded & (system.dt is None)
        self.memory = np.where((self.part > 0.0) | self.direct, self.whole + 1, self.whole)
        self.at = self.n + np.cumsum([0, *self.memory])[:-1]
        self.late, self.fraction = _split(ages)
        self.kept = np.where(self.fraction > 0.0, self.late + 1, self.late)
        ends = self.n + int(self.memory.sum()) + np.cumsum([0, *self.kept])
        self.first, self.total = ends[:-1], int(ends[-1])
        self.hold = _Hold(system, dt, self.part)

    def row(self, states: Array, new: Array, old: Array) -> tuple[Array, Array]:
        """Rows (k) from effects on states (k, n), of the present command (k, n_u) and of the one before it."""
        k = states.shape[-2]
        full, now = np.zeros((*self.batch, k, self.total)), np.zeros((*self.batch, k, self.n_u))
        full[..., : self.n] = states
        for j in range(self.n_u):
            for effect, ago in ((new[..., j], self.whole[j]), (old[..., j], self.whole[j] + 1)):
                if ago == 0:
                    now[..., j] += effect
                elif ago <= self.memory[j]:
                    full[..., self.at[j] + ago - 1] += effect
        return full, now

    def output(self, i: int) -> tuple[Array, Array]:
        """Row of one output: at the sample, or at the time inside the sample to come at which it is taken."""
        c, d = self.plant.C[..., i : i + 1, :], self.plant.D[..., i : i + 1, :]
        if not self.fraction[i]:
            return self.row(c, np.where(self.direct, 0.0, d), np.where(self.direct, d, 0.0))
        inside = 1.0 - self.fraction[i]
        Phi, old, new = self.hold.over(inside)
        switched = inside > self.part
        return self.row(c @ Phi, c @ new + np.where(switched, d, 0.0), c @ old + np.where(switched, 0.0, d))

    def system(self) -> LinearSystem:
        """All rows, with names."""
        p, n_y = self.plant, len(self.plant.outputs)
        A, B = np.zeros((*self.batch, self.total, self.total)), np.zeros((*self.batch, self.total, self.n_u))
        C, D = np.zeros((*self.batch, n_y, self.total)), np.zeros((*self.batch, n_y, self.n_u))
        Phi, old, new = self.hold.over(1.0)
        A[..., : self.n, :], B[..., : self.n, :] = self.row(Phi, new, old)
        for j in range(self.n_u):
            if self.memory[j]:
                B[..., self.at[j], j] = 1.0
        for start, length in (*zip(self.at, self.memory), *zip(self.first, self.kept)):
            step = np.arange(start + 1, start + length)
            A[..., step, step - 1] = 1.0
        for i in range(n_y):
            row, now = self.output(i)
            if not self.kept[i]:
                C[..., i : i + 1, :], D[..., i : i + 1, :] = row, now
                continue
            A[..., self.first[i] : self.first[i] + 1, :] = row
            B[..., self.first[i] : self.first[i] + 1, :] = now
            C[..., i, self.first[i] + self.kept[i] - 1] = 1.0
        past = [*zip(p.inputs, self.memory), *zip(p.outputs, self.kept)]
        names = tuple(f"{name}_{i + 1}_ago" for name, length in past for i in range(length))
        return replace(p, A=A, B=B, C=C, D=D, states=(*p.states, *names), dt=self.dt, input_delay_s=0.0)


def _split(delays: Array) -> tuple[Array, Array]:
    """Whole samples and the fraction beyond them."""
    whole = np.floor(delays + WHOLE).astype(int)
    part = delays - whole
    return whole, np.where(part > WHOLE, part, 0.0)
