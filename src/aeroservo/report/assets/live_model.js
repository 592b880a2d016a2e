"use strict";
/* The simulation of the live panel, without a page: linear models between nodes, the exact sampled step, the roots.

Runs in a browser and in node, where a test compares it with Python's. Matrices are flat arrays, row by row. */
const liveModel = (() => {
  const hex = (text) => { // Python's float.hex, without loss
    const m = /^(-?)0x([01])\.?([0-9a-f]*)p([+-]\d+)$/.exec(text);
    let value = Number(m[2]), place = 1 / 16;
    for (const digit of m[3]) { value += parseInt(digit, 16) * place; place /= 16; }
    return (m[1] ? -1 : 1) * value * 2 ** Number(m[4]);
  };
  const floats = (text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    return new Float64Array(bytes.buffer);
  };
  const lagrange = (nodes, x) => nodes.map((a, i) => nodes.reduce((p, b, j) => (j === i ? p : (p * (x - b)) / (a - b)), 1));
  const multiply = (A, B, n, m, p) => {
    const C = new Float64Array(n * p);
    for (let i = 0; i < n; i++) for (let k = 0; k < m; k++) {
      const a = A[i * m + k];
      if (a !== 0) for (let j = 0; j < p; j++) C[i * p + j] += a * B[k * p + j];
    }
    return C;
  };
  /* exp(A) by scaling and a Taylor polynomial of degree 16 whose remainder is below rounding. */
  const exponential = (A, n) => {
    let norm = 0;
    for (let i = 0; i < n; i++) { let row = 0; for (let j = 0; j < n; j++) row += Math.abs(A[i * n + j]); norm = Math.max(norm, row); }
    const squarings = Math.max(0, Math.ceil(Math.log2(norm / 0.5 || 1e-300)));
    const X = A.map((v) => v / 2 ** squarings);
    let E = new Float64Array(n * n);
    for (let i = 0; i < n; i++) E[i * n + i] = 1;
    for (let k = 16; k >= 1; k--) {
      E = multiply(X, E, n, n, n);
      for (let i = 0; i < n * n; i++) E[i] /= k;
      for (let i = 0; i < n; i++) E[i * n + i] += 1;
    }
    for (let k = 0; k < squarings; k++) E = multiply(E, E, n, n, n);
    return E;
  };
  /* One step of x' = A x + B_c u + B_g w: u held, w a parabola over the step, as in Python's engine. */
  const held = (A, B, n, controls, gusts, dt) => {
    const inputs = controls + gusts, N = n + inputs + 2 * gusts, M = new Float64Array(N * N);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) M[i * N + j] = A[i * n + j] * dt;
      for (let j = 0; j < inputs; j++) M[i * N + n + j] = B[i * inputs + j] * dt;
    }
    for (let j = 0; j < gusts; j++) {
      M[(n + controls + j) * N + n + inputs + j] = 1;
      M[(n + inputs + j) * N + n + inputs + gusts + j] = 1;
    }
    const width = inputs + 2 * gusts, E = exponential(M, N), phi = new Float64Array(n * n), gamma = new Float64Array(n * width);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) phi[i * n + j] = E[i * N + j];
      for (let j = 0; j < width; j++) gamma[i * width + j] = E[i * N + n + j];
    }
    return { phi, gamma };
  };
  /* Eigenvalues of a real matrix: balanced, reduced to Hessenberg form by elimination, then the shifted QR algorithm
  (Wilkinson and Reinsch, Handbook for Automatic Computation II, 1971, contributions II/11 to II/14). */
  const roots = (matrix, n) => {
    const a = Float64Array.from(matrix), at = (i, j) => i * n + j, out = [];
    for (let done = false; !done;) {
      done = true;
      for (let i = 0; i < n; i++) {
        let c = 0, r = 0;
        for (let j = 0; j < n; j++) if (j !== i) { c += Math.abs(a[at(j, i)]); r += Math.abs(a[at(i, j)]); }
        if (!c || !r) continue;
        let f = 1;
        const s = c + r;
        while (c < r / 2) { f *= 2; c *= 4; }
        while (c >= r * 2) { f /= 2; c /= 4; }
        if ((c + r) / f < 0.95 * s) {
          done = false;
          for (let j = 0; j < n; j++) { a[at(i, j)] /= f; }
          for (let j = 0; j < n; j++) { a[at(j, i)] *= f; }
        }
      }
    }
    for (let m = 1; m < n - 1; m++) {
      let p = m;
      for (let i = m; i < n; i++) if (Math.abs(a[at(i, m - 1)]) > Math.abs(a[at(p, m - 1)])) p = i;
      const x = a[at(p, m - 1)];
      if (p !== m) {
        for (let j = m - 1; j < n; j++) [a[at(p, j)], a[at(m, j)]] = [a[at(m, j)], a[at(p, j)]];
        for (let i = 0; i < n; i++) [a[at(i, p)], a[at(i, m)]] = [a[at(i, m)], a[at(i, p)]];
      }
      if (!x) continue;
      for (let i = m + 1; i < n; i++) {
        const y = a[at(i, m - 1)] / x;
        if (!y) continue;
        for (let j = m - 1; j < n; j++) a[at(i, j)] -= y * a[at(m, j)];
        for (let j = 0; j < n; j++) a[at(j, m)] += y * a[at(j, i)];
      }
    }
    for (let i = 2; i < n; i++) for (let j = 0; j < i - 1; j++) a[at(i, j)] = 0;
    let norm = 0;
    for (const v of a) norm += Math.abs(v);
    let last = n - 1, shift = 0, turns = 0;
    while (last >= 0) {
      let l = last;
      for (; l > 0; l--) {
        let s = Math.abs(a[at(l - 1, l - 1)]) + Math.abs(a[at(l, l)]);
        if (s === 0) s = norm;
        if (Math.abs(a[at(l, l - 1)]) <= 2.3e-16 * s) { a[at(l, l - 1)] = 0; break; }
      }
      let x = a[at(last, last)];
      if (l === last) { out.push([x + shift, 0]); last -= 1; turns = 0; continue; }
      let y = a[at(last - 1, last - 1)], w = a[at(last, last - 1)] * a[at(last - 1, last)];
      if (l === last - 1) {
        const p = 0.5 * (y - x), q = p * p + w, z = Math.sqrt(Math.abs(q));
        x += shift;
        if (q >= 0) {
          const zz = p + (p >= 0 ? z : -z);
          out.push([x + zz, 0], [zz ? x - w / zz : x + zz, 0]);
        } else out.push([x + p, z], [x + p, -z]);
        last -= 2;
        turns = 0;
        continue;
      }
      if (turns === 60) return null;
      if (turns === 10 || turns === 20 || turns === 30) {
        shift += x;
        for (let i = 0; i <= last; i++) a[at(i, i)] -= x;
        const s = Math.abs(a[at(last, last - 1)]) + Math.abs(a[at(last - 1, last - 2)]);
        x = y = 0.75 * s;
        w = -0.4375 * s * s;
      }
      turns += 1;
      let m = last - 2, p = 0, q = 0, r = 0;
      for (; m >= l; m--) {
        const z = a[at(m, m)], rr = x - z, ss = y - z;
        p = (rr * ss - w) / a[at(m + 1, m)] + a[at(m, m + 1)];
        q = a[at(m + 1, m + 1)] - z - rr - ss;
        r = a[at(m + 2, m + 1)];
        const s = Math.abs(p) + Math.abs(q) + Math.abs(r);
        p /= s; q /= s; r /= s;
        if (m === l) break;
        const u = Math.abs(a[at(m, m - 1)]) * (Math.abs(q) + Math.abs(r));
        const v = Math.abs(p) * (Math.abs(a[at(m - 1, m - 1)]) + Math.abs(z) + Math.abs(a[at(m + 1, m + 1)]));
        if (u <= 2.3e-16 * v) break;
      }
      for (let i = m + 2; i <= last; i++) { a[at(i, i - 2)] = 0; if (i > m + 2) a[at(i, i - 3)] = 0; }
      for (let k = m; k < last; k++) {
        const more = k !== last - 1;
        if (k !== m) {
          p = a[at(k, k - 1)]; q = a[at(k + 1, k - 1)]; r = more ? a[at(k + 2, k - 1)] : 0;
          x = Math.abs(p) + Math.abs(q) + Math.abs(r);
          if (x !== 0) { p /= x; q /= x; r /= x; }
        }
        const s = (p >= 0 ? 1 : -1) * Math.hypot(p, q, r);
        if (s === 0) continue;
        if (k === m) { if (l !== m) a[at(k, k - 1)] = -a[at(k, k - 1)]; } else a[at(k, k - 1)] = -s * x;
        p += s; x = p / s; y = q / s;
        const z = r / s;
        q /= p; r /= p;
        for (let j = k; j <= last; j++) {
          let t = a[at(k, j)] + q * a[at(k + 1, j)];
          if (more) { t += r * a[at(k + 2, j)]; a[at(k + 2, j)] -= t * z; }
          a[at(k + 1, j)] -= t * y;
          a[at(k, j)] -= t * x;
        }
        const end = Math.min(last, k + 3);
        for (let i = l; i <= end; i++) {
          let t = x * a[at(i, k)] + y * a[at(i, k + 1)];
          if (more) { t += z * a[at(i, k + 2)]; a[at(i, k + 2)] -= t * r; }
          a[at(i, k + 1)] -= t * q;
          a[at(i, k)] -= t;
        }
      }
    }
    return out;
  };

  return function create(data) {
    const axes = ["V", "rho", "factor"].map((name) => data[name].map(hex));
    const n = data.states.length, inputs = data.inputs.length, controls = data.controls, gusts = inputs - controls;
    const A = floats(data.A), B = floats(data.B), pressures = floats(data.pressures), gains = floats(data.K);
    const air = Object.fromEntries(Object.entries(data.atmosphere).map(([k, v]) => [k, hex(v)]));
    const density = (altitude) => air.rho0 * (1 - altitude / air.H) ** air.n;
    const sound = (altitude) => air.a0 * Math.sqrt(1 - altitude / air.H);
    const blended = (all, size, at) => {
      const w = axes.map((nodes, k) => lagrange(nodes, at[k])), out = new Float64Array(size);
      let from = 0;
      for (const a of w[0]) for (const b of w[1]) for (const c of w[2]) {
        const f = a * b * c;
        for (let i = 0; i < size; i++) out[i] += f * all[from + i];
        from += size;
      }
      return out;
    };
    const gain = (pressure) => {
      const size = controls * n, K = new Float64Array(size), count = pressures.length;
      if (!count) return K;
      let low = 0;
      while (low < count - 2 && pressures[low + 1] <= pressure) low++;
      const high = Math.min(low + 1, count - 1);
      const f = count === 1 ? 0 : Math.max(0, Math.min(1, (pressure - pressures[low]) / (pressures[high] - pressures[low])));
      for (let i = 0; i < size; i++) K[i] = gains[low * size + i] + f * (gains[high * size + i] - gains[low * size + i]);
      return K;
    };
    /* Matrices at {V, altitude, factor}. */
    const at = (where) => {
      const rho = density(where.altitude), pressure = 0.5 * rho * where.V * where.V;
      const place = [where.V, rho, where.factor];
      return { A: blended(A, n * n, place), B: blended(B, n * inputs, place), K: gain(pressure), rho, pressure };
    };
    /* Roots [1/s] of the open loop, or of the sampled closed loop. */
    const poles = (where) => {
      const here = at(where);
      if (!where.on || !pressures.length) return roots(here.A, n);
      const step = held(here.A, here.B, n, controls, gusts, data.dt), width = inputs + 2 * gusts, loop = step.phi.slice();
      for (let i = 0; i < n; i++) for (let j = 0; j < n; j++)
        for (let k = 0; k < controls; k++) loop[i * n + j] -= step.gamma[i * width + k] * here.K[k * n + j];
      const z = roots(loop, n);
      return z && z.map(([re, im]) => [Math.log(Math.hypot(re, im)) / data.dt, Math.atan2(im, re) / data.dt]);
    };
    /* A run: `step()` goes on by one of `parts` parts of the sample; `where` may change between steps. */
    const run = (where, parts = 10) => {
      const x = new Float64Array(n), u = new Float64Array(controls), dt = data.dt / parts;
      let now = null, key = "", k = 0, pulses = [];
      const wind = (t) => {
        let w = 0;
        for (const p of pulses) {
          const way = p.V * (t - p.start);
          if (way > 0 && way < p.length) w += 0.5 * p.amplitude * (1 - Math.cos((2 * Math.PI * way) / p.length));
        }
        return w;
      };
      const self = {
        x, u, get t() { return k * dt; }, wind,
        set(change) {
          where = { ...where, ...change };
          const next = [where.V, where.altitude, where.factor].join();
          if (next !== key) {
            key = next;
            const here = at(where);
            now = { ...here, ...held(here.A, here.B, n, controls, gusts, dt) };
          }
          return now;
        },
        gust(amplitude, length, start = k * dt) { pulses.push({ amplitude, length, start, V: where.V }); pulses = pulses.slice(-8); },
        reset() { x.fill(0); u.fill(0); pulses = []; },
        step() {
          if (k % parts === 0) {
            for (let i = 0; i < controls; i++) {
              u[i] = 0;
              if (where.on) for (let j = 0; j < n; j++) u[i] -= now.K[i * n + j] * x[j];
            }
          }
          const width = inputs + 2 * gusts, t = k * dt, next = new Float64Array(n), v = new Float64Array(width);
          for (let i = 0; i < controls; i++) v[i] = u[i];
          for (let j = 0; j < gusts; j++) {
            const late = data.offsets[j] / where.V, a = wind(t - late), m = wind(t + 0.5 * dt - late), b = wind(t + dt - late);
            v[controls + j] = a; // value, slope and curvature at the start of the step, the step being 1
            v[inputs + j] = 4 * m - 3 * a - b;
            v[inputs + gusts + j] = 4 * (b - 2 * m + a);
          }
          for (let i = 0; i < n; i++) {
            let s = 0;
            for (let j = 0; j < n; j++) s += now.phi[i * n + j] * x[j];
            for (let j = 0; j < width; j++) s += now.gamma[i * width + j] * v[j];
            next[i] = s;
          }
          x.set(next);
          k += 1;
        },
      };
      self.set({});
      return self;
    };
    return { at, poles, run, density, sound, gain, n, controls, gusts, states: data.states, inputs: data.inputs, hasGains: pressures.length > 0 };
  };
})();
if (typeof module !== "undefined") module.exports = liveModel;
