"""Compiled stepping of a time-varying system with a few nonlinear elements and a sampled controller.

Imports nothing of ours. Every model is one stack of rows Z(t) over the columns xi = [x, w, s, phi, 1]:

    rows 0 .. n_x:            x' = Z xi
    next n_phi rows:          argument of each nonlinear element, which may use elements before it
    next n_y rows:            outputs

w are inputs that live in time (gusts), s are held over a base step (commands), phi are the elements' values. Only the
first `live` columns and phi change inside a step; the rest is summed once (`steady`). All arrays of state are changed
in place, so that a run can be cut into pieces.

Over budget because the loop that runs a million times is compiled as one piece.
"""

from __future__ import annotations

import numpy as np
from numba import njit

SPRING, TABLE, CLIP, COSINE, PLAY = 0, 1, 2, 3, 4
OVERFLOW = 1e30
SPLITS = 6  # of one step, at corners of its elements


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def element(kind, y, pars, j, memory):
    """Value of one nonlinear element at its argument; row j of pars (par below) holds its numbers."""
    if kind == SPRING:  # -(force - linear force): par = linear, gap, K, count, c0, c1, ...
        gap = pars[j, 1]
        x = y - gap if y > gap else (y + gap if y < -gap else 0.0)
        total = 0.0
        for i in range(int(pars[j, 3]) - 1, -1, -1):
            total = total * x + pars[j, 4 + i]
        return pars[j, 0] * y - pars[j, 2] * total * x
    if kind == TABLE:  # table - straight line: par = CL0, slope, count, alpha..., CL...
        count = int(pars[j, 2])
        line = pars[j, 0] + pars[j, 1] * y
        if y <= pars[j, 3]:
            return pars[j, 3 + count] - line
        for i in range(1, count):
            if y <= pars[j, 3 + i]:
                left = pars[j, 2 + i]
                f = (y - left) / (pars[j, 3 + i] - left)
                return pars[j, 2 + count + i] * (1.0 - f) + pars[j, 3 + count + i] * f - line
        return pars[j, 2 + 2 * count] - line
    if kind == CLIP:  # par = largest magnitude
        return pars[j, 0] if y > pars[j, 0] else (-pars[j, 0] if y < -pars[j, 0] else y)
    if kind == COSINE:
        return np.cos(y) - 1.0
    return y - pars[j, 0] if y - pars[j, 0] > memory else (y + pars[j, 0] if y + pars[j, 0] < memory else memory)


@njit(cache=True, nogil=True, error_model="numpy")
def piece(kind, y, pars, j, memory):
    """Number of the smooth piece of an element in which its argument is: a change is a corner."""
    if kind == TABLE:
        i = 0
        while i < int(pars[j, 2]) and y > pars[j, 3 + i]:
            i += 1
        return i
    if kind == COSINE or (kind == SPRING and pars[j, 1] == 0.0):
        return 0
    middle = memory if kind == PLAY else 0.0
    width = pars[j, 1] if kind == SPRING else pars[j, 0]
    return 1 if y > middle + width else (2 if y < middle - width else 0)


@njit(cache=True, nogil=True, error_model="numpy")
def steady(Z, count, live, first, xi, out):
    """Part of the first `count` rows that does not change inside a step: what is held, and the one."""
    last = Z.shape[1] - 1
    for r in range(count):
        total = Z[r, last]
        for i in range(live, first):
            total += Z[r, i] * xi[i]
        out[r] = total


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def elements(Z, n_x, live, first, kinds, pars, memory, xi, fixed, args):
    """Fill the phi columns of xi, in order, and their arguments."""
    for j in range(kinds.shape[0]):
        y = fixed[n_x + j]
        for i in range(live):
            y += Z[n_x + j, i] * xi[i]
        for i in range(j):
            y += Z[n_x + j, first + i] * xi[first + i]
        args[j] = y
        xi[first + j] = element(kinds[j], y, pars, j, memory[j])


@njit(cache=True, nogil=True, error_model="numpy")
def corner(kinds, pars, memory, start, end):
    """Part of a step after which the first element leaves its smooth piece; 1 if none does. Arguments run straight."""
    found = 1.0
    for j in range(kinds.shape[0]):
        here = piece(kinds[j], start[j], pars, j, memory[j])
        if piece(kinds[j], end[j], pars, j, memory[j]) != here:
            low, high = 0.0, 1.0
            for _ in range(40):
                middle = 0.5 * (low + high)
                if piece(kinds[j], start[j] + middle * (end[j] - start[j]), pars, j, memory[j]) == here:
                    low = middle
                else:
                    high = middle
            found = min(found, high)
    return found


@njit(cache=True, nogil=True, error_model="numpy")
def rows(Z, start, count, live, first, n_phi, xi, fixed, out):
    """out = rows start .. start + count of Z times xi, the fixed part being known."""
    for r in range(count):
        total = fixed[start + r]
        for i in range(live):
            total += Z[start + r, i] * xi[i]
        for i in range(n_phi):
            total += Z[start + r, first + i] * xi[first + i]
        out[r] = total


@njit(cache=True, nogil=True, error_model="numpy")
def derivative(Z, n_x, first, kinds, pars, memory, xi):
    """x' for a filled xi (states, inputs and the one); for tests and linearisation."""
    out, fixed = np.empty(n_x), np.empty(Z.shape[0])
    steady(Z, Z.shape[0], n_x, first, xi, fixed)
    elements(Z, n_x, n_x, first, kinds, pars, memory, xi, fixed, np.empty(kinds.shape[0]))
    rows(Z, 0, n_x, n_x, first, kinds.shape[0], xi, fixed, out)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def wind(xi, at, held, k, path, speed, dt, f, cosines, offsets):
    """Gusts, and the rates of the smooth ones, at the fraction f of base step k: held values and 1-cosine pulses."""
    here = path[k] + dt * f * (speed[k] + 0.5 * f * (speed[k + 1] - speed[k]))
    V = speed[k] + f * (speed[k + 1] - speed[k])
    zones = offsets.shape[0]
    for z in range(zones):
        value, rate = held[k, z], 0.0
        for c in range(cosines.shape[0]):
            x = here - cosines[c, 1] - offsets[z]
            if x > 0.0 and x < cosines[c, 2]:
                turn = 2.0 * np.pi / cosines[c, 2]
                value += 0.5 * cosines[c, 0] * (1.0 - np.cos(turn * x))
                rate += 0.5 * cosines[c, 0] * turn * np.sin(turn * x) * V
        xi[at + z] = value
        xi[at + zones + z] = rate


@njit(cache=True, nogil=True, error_model="numpy")
def interpolate(knots, per_knot, position, out):
    """Rows between knots, linear in time; `position` counts base steps from the first knot."""
    if knots.shape[0] == 1:
        return
    i = min(int(position / per_knot), knots.shape[0] - 2)
    f = position / per_knot - i
    for r in range(out.shape[0]):
        for c in range(out.shape[1]):
            out[r, c] = knots[i, r, c] + f * (knots[i + 1, r, c] - knots[i, r, c])


@njit(cache=True, nogil=True, error_model="numpy")
def measure(ring, ring_at, delays, noise, at, quanta, first, new):
    """Measured values of a sample into `new` from `first` on: aged, with noise, rounded."""
    length = ring.shape[0]
    for i in range(delays.shape[0]):
        value = ring[(ring_at - delays[i]) % length, i] + noise[at, i]
        if quanta[i] > 0.0:
            value = np.round(value / quanta[i]) * quanta[i]
        new[first + i] = value


@njit(cache=True, nogil=True, error_model="numpy")
def blended(matrices, start, count, width, point, weight, values, out):
    """out = rows start .. start + count of the matrices between two points, times the first `width` values."""
    low, high = matrices[point], matrices[min(point + 1, matrices.shape[0] - 1)]
    for r in range(count):
        total = 0.0
        for i in range(width):
            total += (low[start + r, i] + weight * (high[start + r, i] - low[start + r, i])) * values[i]
        out[r] = total


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def clipped(value, largest):
    """The value within its limit; 0 is no limit."""
    return min(max(value, -largest), largest) if largest > 0.0 else value


@njit(cache=True, nogil=True, error_model="numpy")
def control(
    matrices, sizes, weights, at, ring, ring_at, delays, noise, quanta, limits, xc, new, command
):
    """One sample of the controller: measured values -> command within its limits; matrices are blended between points.

    Columns of `matrices` are states, measurements and what the limits cut off each command (for the states alone).
    """
    n_c, n_in, n_out = sizes
    point, weight = int(weights[at, 0]), weights[at, 1]
    measure(ring, ring_at, delays, noise, at, quanta, n_c, new)
    for i in range(n_c):
        new[i] = xc[i]
    blended(matrices, n_c, n_out, n_c + n_in, point, weight, new, command)
    for r in range(n_out):
        held = clipped(command[r], limits[r])
        new[n_c + n_in + r] = held - command[r]
        command[r] = held
    blended(matrices, 0, n_c, n_c + n_in + n_out, point, weight, new, xc)


@njit(cache=True, nogil=True, error_model="numpy")
def least_squares(
    phi, target, forget, ceiling, robust, lower, upper, root, theta, noise, push
):
    """One step of recursive least squares with forgetting; `root`, `theta`, `noise` change in place; fills `push`.

    The covariance is root root', so that it stays symmetric and positive (Potter). noise: variance of each residual,
    then the number of samples it stands on. Residuals beyond `robust` deviations weigh less (0: all weigh alike); the
    covariance is not forgotten where its trace would pass `ceiling`; parameters are held within their bounds. push:
    regressor times residual, of which the error of the parameters is made.
    """
    n, m = theta.shape
    trace = 0.0
    for i in range(n):
        for j in range(n):
            trace += root[i, j] * root[i, j]
    keep = forget if trace <= ceiling * forget else 1.0
    heavy = 1.0
    error = np.empty(m)
    for j in range(m):
        error[j] = target[j]
        for i in range(n):
            error[j] -= theta[i, j] * phi[i]
        if robust > 0.0 and noise[m] >= 50.0:
            size = robust * np.sqrt(noise[j])
            if abs(error[j]) > size and abs(error[j]) > 0.0:
                heavy = min(heavy, size / abs(error[j]))
    f, g = np.zeros(n), np.zeros(n)
    for j in range(n):
        for i in range(n):
            f[j] += root[i, j] * phi[i]
        f[j] *= np.sqrt(heavy)
    square = keep
    for j in range(n):
        square += f[j] * f[j]
    for i in range(n):
        for j in range(n):
            g[i] += root[i, j] * f[j]
    part = 1.0 / (square + np.sqrt(keep * square))
    for i in range(n):
        for j in range(n):
            root[i, j] = (root[i, j] - part * g[i] * f[j]) / np.sqrt(keep)
    count = noise[m] * forget + 1.0
    for j in range(m):
        for i in range(n):
            moved = theta[i, j] + g[i] / square * np.sqrt(heavy) * error[j]
            theta[i, j] = min(max(moved, lower[i, j]), upper[i, j])
            push[i, j] = heavy * phi[i] * error[j]
        noise[j] += (heavy * error[j] * error[j] - noise[j]) / count
    noise[m] = count


@njit(cache=True, nogil=True, error_model="numpy")
def deviations(root, pile, out):
    """Standard deviation of each parameter, P pile P with P = root root'; returns the trace of P.

    pile[j]: what the residuals of target j did to the parameters, block by block, squared and summed. Disturbances of
    any colour are allowed for, as far as they forget within a block.
    """
    n, m = out.shape
    P = np.zeros((n, n))
    trace = 0.0
    for i in range(n):
        for c in range(n):
            for j in range(n):
                P[i, c] += root[i, j] * root[c, j]
        trace += P[i, i]
    for i in range(n):
        for j in range(m):
            variance = 0.0
            for k in range(n):
                for c in range(n):
                    variance += P[i, k] * pile[j, k, c] * P[i, c]
            out[i, j] = np.sqrt(max(variance, 0.0))
    return trace


@njit(cache=True, nogil=True, error_model="numpy")
def adapt(
    matrices, sizes, weights, at, ring, ring_at, delays, noise, quanta, limits, xc, new, command,
    watch, force, numbers, bounds, shares, scaled, dither, memory, fx, root, theta, spread, block, pile, record,
):  # fmt: skip
    """One sample of an adaptive controller: identify, judge, and scale what the schedule commands.

    `watch` are the matrices of the filter that makes targets and regressors, `force` what a target is divided by;
    numbers: forgetting, ceiling of the
    covariance, robustness, largest error of a parameter that is used, least and largest gain, largest change of the
    gain in a sample, error below which nothing is added to the command, samples before anything is used, largest trace
    of the covariance with which anything is used (excitation is there), samples in a block; memory: gain, samples so
    far; block, pile: of `deviations`.
    """
    n_c, n_in, n_out = sizes
    n, m = theta.shape
    n_f = fx.shape[0]
    point, weight = int(weights[at, 0]), weights[at, 1]
    measure(ring, ring_at, delays, noise, at, quanta, n_c, new)
    seen, out, push = np.empty(n_f + n_in), np.empty(m + n), np.zeros((n, m))
    for i in range(n_f):
        seen[i] = fx[i]
    for i in range(n_in):
        seen[n_f + i] = new[n_c + i]
    blended(watch, n_f, m + n, n_f + n_in, point, weight, seen, out)
    blended(watch, 0, n_f, n_f + n_in, point, weight, seen, fx)
    after = min(point + 1, force.shape[0] - 1)
    for j in range(m):
        out[j] /= force[point, j] + weight * (force[after, j] - force[point, j])
    if memory[1] >= 3.0:  # the filter holds real samples
        least_squares(out[m:], out[:m], numbers[0], numbers[1], numbers[2], bounds[0], bounds[1], root, theta, spread,
                      push)  # fmt: skip
    memory[1] += 1.0
    for i in range(n):
        for j in range(m):
            block[i, j] += push[i, j]
    if int(memory[1]) % int(numbers[10]) == 0:
        fade = numbers[0] ** (2.0 * numbers[10])
        for j in range(m):
            for i in range(n):
                for k in range(n):
                    pile[j, i, k] = fade * pile[j, i, k] + block[i, j] * block[k, j]
        block[:] = 0.0
    error = np.empty((n, m))
    trace = deviations(root, pile, error)
    worst, effect = 0.0, 0.0
    low, high = shares[point], shares[min(point + 1, shares.shape[0] - 1)]
    for i in range(n):
        for j in range(m):
            record[at, i * m + j] = theta[i, j]
            record[at, n * m + i * m + j] = error[i, j]
            worst = max(worst, error[i, j])
            effect += (low[i, j] + weight * (high[i, j] - low[i, j])) * theta[i, j]
    known = memory[1] >= numbers[8] and worst <= numbers[3] and trace <= numbers[9]
    wanted = 1.0
    if known:
        wanted = numbers[5] if effect * numbers[5] <= 1.0 else max(1.0 / effect, numbers[4])
    gain = memory[0] + min(max(wanted - memory[0], -numbers[6]), numbers[6])
    memory[0] = gain
    record[at, 2 * n * m] = gain
    record[at, 2 * n * m + 1] = 1.0 if known else 0.0
    for i in range(n_c):
        new[i] = xc[i]
    for i in range(n_in):
        if scaled[i]:
            new[n_c + i] /= gain
    blended(matrices, n_c, n_out, n_c + n_in, point, weight, new, command)
    stir = 0.0 if known and worst <= numbers[7] else 1.0
    for r in range(n_out):
        free = 1.0  # the oscillation gives way to commands beyond a third of the limit
        if limits[r] > 0.0:
            free = min(1.0, max(0.0, 2.0 - 3.0 * abs(gain * command[r]) / limits[r]))
        added = stir * free * dither[int(memory[1]) % dither.shape[0], r]
        held = clipped(gain * command[r] + added, limits[r])
        new[n_c + n_in + r] = held / gain - command[r]
        command[r] = held
    blended(matrices, 0, n_c, n_c + n_in + n_out, point, weight, new, xc)


@njit(cache=True, nogil=True, error_model="numpy")
def step_rk4(
    Z, knots, per_knot, n_x, live, first, moving, kinds, pars, memory, xi, x, h, k, f0, f1,
    held, path, speed, dt, cosines, offsets, fixed, args, k1, k2,
):  # fmt: skip
    """One classical Runge-Kutta step of x; xi holds what is held and the one; k1, k2 are work."""
    n_phi = kinds.shape[0]
    for i in range(n_x):
        k1[i] = 0.0
        k2[i] = 0.0
    for stage in range(4):
        if moving and stage != 2:
            place = f0 if stage == 0 else (f1 if stage == 3 else 0.5 * (f0 + f1))
            interpolate(knots, per_knot, k + place, Z)
            steady(Z, n_x + n_phi, live, first, xi, fixed)
        if live > n_x:
            f = f0 if stage == 0 else (f1 if stage == 3 else 0.5 * (f0 + f1))
            wind(xi, n_x, held, k, path, speed, dt, f, cosines, offsets)
        forward = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
        weight = 1.0 if stage == 0 or stage == 3 else 2.0
        for i in range(n_x):
            xi[i] = x[i] + forward * k1[i]
        if n_phi > 0:
            elements(Z, n_x, live, first, kinds, pars, memory, xi, fixed, args)
        for r in range(n_x):  # `rows` in place: the loop in which all the time goes
            total = fixed[r]
            for i in range(live):
                total += Z[r, i] * xi[i]
            k1[r] = total
        for p in range(n_phi):
            value = xi[first + p]
            for r in range(n_x):
                k1[r] += Z[r, first + p] * value
        for i in range(n_x):
            k2[i] += weight * k1[i]
    for i in range(n_x):
        x[i] += h / 6.0 * k2[i]
        xi[i] = x[i]
    if n_phi > 0:
        elements(Z, n_x, live, first, kinds, pars, memory, xi, fixed, args)


@njit(cache=True, nogil=True, error_model="numpy")
def settle(n_x, first, kinds, memory, stops, x, xi):
    """After a step: hard stops of the surfaces, and the memory of elements with play, whose values xi holds."""
    for j in range(stops.shape[0]):
        i, r, largest = int(stops[j, 0]), int(stops[j, 1]), stops[j, 2]
        if x[i] > largest:
            x[i] = largest
            if r >= 0 and x[r] > 0.0:
                x[r] = 0.0
        elif x[i] < -largest:
            x[i] = -largest
            if r >= 0 and x[r] < 0.0:
                x[r] = 0.0
    for j in range(kinds.shape[0]):
        if kinds[j] == PLAY:
            memory[j] = xi[first + j]


@njit(cache=True, nogil=True, error_model="numpy")
def run(
    knots, per_knot, sizes, kinds, pars, memory, stops, exact, n_sub, dt, k_start, n_step,
    x, held, path, speed, cosines, offsets, external,
    ctrl, ctrl_sizes, ctrl_weights, ctrl_rows, ctrl_delays, ctrl_quanta, ctrl_noise, ctrl_limits, ctrl_map,
    period, computing, first_sample, xc, ring, latest, queue, pipe, pipe_delays, gains, command_limits, commands,
    watch, force, numbers, bounds, shares, scaled, dither, memory_a, fx, root, theta, spread, block, pile, adapted,
    limit_rows, limit_values, statistics, every, record, trace,
):  # fmt: skip
    """Step `n_step` base steps from step `k_start`; returns code, steps done, records written, row of a limit left.

    Code 0: done; 1: a limit was left; 2: overflow. Outputs of the start of each base step go into the statistics
    (rows: largest magnitude, sum, sum of squares, count) and, at every `every`th, into `record`.
    """
    n_x, n_w, n_s, n_phi, n_y = sizes
    n_col = n_x + n_w + n_s + n_phi + 1
    first = n_x + n_w + n_s
    n_u = external.shape[1]
    xi, k1, k2 = np.zeros(n_col), np.zeros(n_x), np.zeros(n_x)
    y, work, command = np.zeros(n_y), np.zeros(ctrl.shape[2] + 1), np.zeros(ctrl_map.shape[0])
    Z0 = knots[0].copy()
    Phi, drive = exact
    back = np.zeros(n_x)
    moving = knots.shape[0] > 1
    fixed, args, ahead = np.zeros(knots.shape[1]), np.zeros(n_phi), np.zeros(n_phi)
    live = n_x + (n_w if cosines.shape[0] > 0 else 0)
    written = 0
    xi[n_col - 1] = 1.0
    for j in range(n_s):
        xi[n_x + n_w + j] = commands[j]  # what was held before this piece
    for k in range(n_step):
        now = k_start + k
        if moving:
            interpolate(knots, per_knot, float(k), Z0)
        for i in range(n_x):
            xi[i] = x[i]
        wind(xi, n_x, held, k, path, speed, dt, 0.0, cosines, offsets)
        # the controller reads outputs that are still under the old command
        if ctrl_map.shape[0] > 0:
            slot = now % ring.shape[0]
            if ring.shape[0] > 1 or now % period == 0:
                steady(Z0, Z0.shape[0], live, first, xi, fixed)
                elements(Z0, n_x, live, first, kinds, pars, memory, xi, fixed, ahead)
                for i in range(ctrl_rows.shape[0]):
                    rows(Z0, n_x + n_phi + ctrl_rows[i], 1, live, first, n_phi, xi, fixed, y)
                    ring[slot, i] = y[0]
                    if now == 0:
                        for older in range(ring.shape[0]):
                            ring[older, i] = y[0]
            if now % period == 0:
                sample = now // period - first_sample
                if theta.shape[0] == 0:
                    control(ctrl, ctrl_sizes, ctrl_weights, sample, ring, slot, ctrl_delays, ctrl_noise, ctrl_quanta,
                            ctrl_limits, xc, work, command)  # fmt: skip
                else:
                    adapt(ctrl, ctrl_sizes, ctrl_weights, sample, ring, slot, ctrl_delays, ctrl_noise, ctrl_quanta,
                          ctrl_limits, xc, work, command,
                          watch, force, numbers, bounds, shares, scaled, dither, memory_a, fx, root, theta, spread,
                          block, pile, adapted)  # fmt: skip
                for r in range(ctrl_map.shape[0]):
                    latest[r] = command[r]
            for r in range(ctrl_map.shape[0]):
                queue[now % queue.shape[0], r] = latest[r]
        for j in range(n_u):
            total = external[k, j]
            for r in range(ctrl_map.shape[0]):
                if ctrl_map[r] == j:
                    total += queue[(now - computing) % queue.shape[0], r]
            length = pipe.shape[0]
            pipe[now % length, j] = total
            late = gains[j] * pipe[(now - pipe_delays[j]) % length, j]
            if command_limits[j] > 0.0:
                late = min(max(late, -command_limits[j]), command_limits[j])
            xi[n_x + n_w + j] = late
            xi[n_x + n_w + n_u + j] = total
            commands[j] = late
            commands[n_u + j] = total
        # outputs
        steady(Z0, Z0.shape[0], live, first, xi, fixed)
        elements(Z0, n_x, live, first, kinds, pars, memory, xi, fixed, args)
        rows(Z0, n_x + n_phi, n_y, live, first, n_phi, xi, fixed, y)
        for i in range(n_y):
            size = abs(y[i])
            if size > statistics[0, i]:
                statistics[0, i] = size
            statistics[1, i] += y[i]
            statistics[2, i] += y[i] * y[i]
            statistics[3, i] += 1.0
        if now % every == 0 and written < record.shape[0]:
            for i in range(n_y):
                record[written, i] = y[i]
            written += 1
        for i in range(limit_rows.shape[0]):
            if abs(y[limit_rows[i]]) > limit_values[i]:
                return 1, k, written, limit_rows[i]
        # the step
        if Phi.shape[0] > 0:
            for r in range(n_x):
                total = 0.0
                for i in range(n_x):
                    total += Phi[r, i] * x[i]
                for i in range(n_s):
                    total += drive[0, r, i] * xi[n_x + n_w + i]
                total += drive[0, r, n_s]
                for i in range(n_w):
                    total += drive[1, r, i] * xi[n_x + i]
                k1[r] = total
            for part in range(2):
                wind(xi, n_x, held, k, path, speed, dt, 0.5 + 0.5 * part, cosines, offsets)
                for r in range(n_x):
                    for i in range(n_w):
                        k1[r] += drive[2 + part, r, i] * xi[n_x + i]
            for i in range(n_x):
                x[i] = k1[i]
        else:
            for sub in range(n_sub):
                f0, f1 = sub / n_sub, (sub + 1.0) / n_sub
                goal, splits = f1, 0
                while f0 < f1:
                    for i in range(n_x):
                        back[i] = x[i]
                    step_rk4(Z0, knots, per_knot, n_x, live, first, moving, kinds, pars, memory, xi, x,
                             (goal - f0) * dt, k, f0, goal, held, path, speed, dt, cosines, offsets, fixed, ahead,
                             k1, k2)  # fmt: skip
                    if goal == f1 and splits < SPLITS:
                        part = corner(kinds, pars, memory, args, ahead)
                        if part < 1.0:  # a corner inside: step to it first, then on from it
                            for i in range(n_x):
                                x[i] = back[i]
                            splits += 1
                            goal = f0 + max(part, 1e-3) * (f1 - f0)
                            continue
                    settle(n_x, first, kinds, memory, stops, x, xi)
                    for j in range(n_phi):
                        args[j] = ahead[j]
                    f0, goal = goal, f1
                if trace.shape[0] > 0:
                    for i in range(n_x):
                        trace[k * n_sub + sub, i] = x[i]
        for i in range(n_x):
            if not abs(x[i]) < OVERFLOW:
                return 2, k, written, i
    return 0, n_step, written, -1


@njit(cache=True, nogil=True, error_model="numpy")
def coloured(Ad, Ld, C, hold, start, x, noise, out):
    """Output C x of x <- Ad x + Ld noise over the steps of a piece; x is carried on; matrices serve `hold` steps."""
    n = x.shape[0]
    new = np.empty(n)
    for k in range(noise.shape[0]):
        i = min((start + k) // hold, Ad.shape[0] - 1)
        total = 0.0
        for c in range(n):
            total += C[i, 0, c] * x[c]
        out[k] = total
        for r in range(n):
            total = 0.0
            for c in range(n):
                total += Ad[i, r, c] * x[c] + Ld[i, r, c] * noise[k, c]
            new[r] = total
        for r in range(n):
            x[r] = new[r]
