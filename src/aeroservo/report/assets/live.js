"use strict";
/* The live panel: sliders, the wing, a trace over time. All mechanics are in live_model.js. */
function createLive(container, data) {
  const model = liveModel(data), where = { ...data.start };
  const run = model.run(where, 10);
  const el = (tag, attributes = {}, ...inner) => {
    const e = document.createElement(tag);
    for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
    e.append(...inner);
    return e;
  };
  const left = el("div"), right = el("div", { class: "sliders" }), stage = el("div");
  const grid = el("div", { class: "live-grid" }, left, right);
  const trace = el("canvas", { class: "trace", role: "img", "aria-label": "Deflection, twist and controls over time" });
  const buttons = el("div", { class: "controls" });
  container.append(grid);
  left.append(stage, trace, buttons);
  const wing = createWing(stage, data.scene, { live: true });
  const numbers = el("dl");
  const rows = {};
  const row = (name, key) => { rows[key] = el("dd", { "data-name": key }, "–"); numbers.append(el("dt", {}, name), rows[key]); };
  const slider = (text, key, unit, digits) => {
    const [low, high] = data.limits[key];
    if (high - low < 1e-9) return;
    const input = el("input", { type: "range", min: low, max: high, step: (high - low) / 400, value: where[key], name: key });
    const out = el("output");
    const say = () => { out.textContent = `${Number(input.value).toFixed(digits)} ${unit}`; };
    input.addEventListener("input", () => { where[key] = Number(input.value); say(); changed(); });
    say();
    right.append(el("label", {}, text + ": ", out, input));
  };
  slider("Airspeed", "V", "m/s", 1);
  slider("Altitude", "altitude", "m", 0);
  slider("Torsional stiffness, × the model's", "factor", "", 2);
  slider("Gust", "gust", "m/s", 2);
  const on = el("input", { type: "checkbox", name: "on" });
  on.disabled = !model.hasGains;
  right.append(el("label", {}, on, model.hasGains ? " Controller on" : " Controller: this model has no control to move"));
  on.addEventListener("change", () => { where.on = on.checked; changed(); });
  right.append(numbers);
  row("Density, kg/m³", "rho");
  row("Dynamic pressure, Pa", "pressure");
  row("Mach number", "mach");
  row("Growth rate, 1/s", "growth");
  row("Frequency, Hz", "frequency");
  row("Damping ratio ζ", "damping");
  row("The wing is", "verdict");
  const play = el("button", { type: "button", class: "play", "aria-pressed": "false" }, "Play");
  const again = el("button", { type: "button", class: "gust" }, "Gust now");
  const rest = el("button", { type: "button" }, "At rest");
  const clock = el("input", { type: "range", min: -3, max: 0, step: 0.05, value: Math.log10(Math.min(1, 0.8 / Math.max(data.frequency, 0.1))), "aria-label": "Clock" });
  const clockOut = el("output");
  const sayClock = () => { clockOut.textContent = "× " + (10 ** Number(clock.value)).toPrecision(2); };
  clock.addEventListener("input", sayClock);
  sayClock();
  buttons.append(play, again, rest, el("label", {}, "Clock", clock, clockOut));

  // the root that grows most, or would next: a stable real root (a lag of the air) says nothing
  const critical = (all) => {
    const most = (list) => list.reduce((a, b) => (b[0] > a[0] ? b : a));
    const top = most(all), swinging = all.filter(([re, im]) => Math.abs(im) > 1e-6 * Math.hypot(re, im));
    return top[0] > 0 || !swinging.length ? top : most(swinging);
  };
  const digits = (v, n) => (Number.isFinite(v) ? Number(v.toPrecision(n)).toString().replace("-", "−") : "–");
  let timer = 0, root = null;
  function readings() {
    const here = model.at(where), all = model.poles(where);
    root = all && critical(all);
    rows.rho.textContent = digits(here.rho, 5);
    rows.pressure.textContent = digits(here.pressure, 5);
    rows.mach.textContent = digits(where.V / model.sound(where.altitude), 4);
    const [re, im] = root || [NaN, NaN];
    rows.growth.textContent = digits(re, 5);
    rows.frequency.textContent = digits(Math.abs(im) / 2 / Math.PI, 5);
    rows.damping.textContent = digits(-re / Math.hypot(re, im), 4);
    const bad = re > 0;
    rows.verdict.textContent = bad ? (Math.abs(im) > 0 ? "unstable: flutter" : "unstable: diverges") : "stable";
    rows.verdict.classList.toggle("unstable", bad);
  }
  function changed() {
    run.set({ V: where.V, altitude: where.altitude, factor: where.factor, on: where.on });
    clearTimeout(timer);
    timer = setTimeout(() => { timer = 0; readings(); }, 30);
  }
  const values = new Float32Array(wing.names.length);
  const history = [];
  const shownFor = Math.max(12 / Math.max(data.frequency, 0.05), 0.5);
  let playing = false, last = null, visible = true, nextGust = 0, stopped = "", scale = 1;
  const output = (o) => {
    if (o.control !== undefined) return run.u[o.control] * o.factor;
    let s = 0;
    for (let j = 0; j < o.row.length; j++) s += o.row[j] * run.x[j];
    return s;
  };
  function show() {
    for (const s of data.shapes) values[s.shape] = s.state !== undefined ? run.x[s.state] : run.u[s.control];
    wing.setState(values, run.t);
  }
  function fire() {
    run.gust(where.gust, data.gust.length);
    wing.showGust((t) => run.wind(t), where.V, Math.max(where.gust, 1e-9));
    nextGust = run.t + Math.max(2.5 / Math.max(data.frequency, 0.05), (3 * data.gust.length) / where.V, 14 / Math.max(data.frequency, 0.05));
  }
  function draw() {
    const w = trace.clientWidth, h = trace.clientHeight, ratio = Math.min(devicePixelRatio || 1, 2);
    if (trace.width !== Math.round(w * ratio)) { trace.width = Math.round(w * ratio); trace.height = Math.round(h * ratio); }
    const g = trace.getContext("2d"), style = getComputedStyle(container), ink = (name) => style.getPropertyValue(name).trim() || "#777";
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = ink("--paper");
    g.fillRect(0, 0, w, h);
    g.font = "12px system-ui, sans-serif";
    const count = data.outputs.length, lane = h / count, until = run.t, since = until - shownFor;
    data.outputs.forEach((o, k) => {
      const middle = lane * (k + 0.5);
      let largest = 1e-9;
      for (const p of history) largest = Math.max(largest, Math.abs(p[k + 1]));
      g.strokeStyle = ink("--grid");
      g.beginPath(); g.moveTo(0, middle); g.lineTo(w, middle); g.stroke();
      g.strokeStyle = ink(["--c0", "--c1", "--c2", "--c3"][k % 4]);
      g.lineWidth = 1.5;
      g.beginPath();
      history.forEach((p, i) => {
        const x = ((p[0] - since) / shownFor) * w, y = middle - (p[k + 1] / largest) * 0.42 * lane;
        i ? g.lineTo(x, y) : g.moveTo(x, y);
      });
      g.stroke();
      g.fillStyle = ink("--ink");
      g.fillText(history.length ? `${o.name}, ±${largest.toPrecision(2)} ${o.unit}` : o.name, 6, lane * k + 14);
    });
  }
  let told = 0, drawn = 0;
  function frame(now) {
    requestAnimationFrame(frame);
    if (!visible || !playing) { last = null; return; }
    const passed = last === null ? 0 : Math.min(0.1, (now - last) / 1000);
    last = now;
    const until = run.t + passed * 10 ** Number(clock.value);
    let steps = 0;
    while (run.t < until && steps < 400) {
      if (run.t >= nextGust && where.gust > 0) fire();
      run.step();
      if (steps % 4 === 0) history.push([run.t, ...data.outputs.map(output)]);
      steps += 1;
    }
    const since = run.t - shownFor;
    while (history.length && history[0][0] < since) history.shift();
    const tip = Math.max(...values.map(Math.abs));
    let moved = 0;
    data.outputs.forEach((o) => { if (o.unit === "m") moved = Math.max(moved, Math.abs(output(o))); if (o.unit === "°" && o.row) moved = Math.max(moved, (Math.abs(output(o)) / 60) * data.largest); });
    if (moved > data.largest || !Number.isFinite(tip)) {
      stopped = "It grew beyond what linear theory may say: at rest again.";
      toRest();
    }
    show();
    if (now - drawn > 200) { draw(); drawn = now; }
    if (now - told > 200) { wing.readout.textContent = `t = ${run.t.toFixed(2)} s${stopped ? "\n" + stopped : ""}`; told = now; }
  }
  function toRest() { run.reset(); history.length = 0; nextGust = run.t; show(); }
  play.addEventListener("click", () => { playing ? api.pause() : api.play(); });
  again.addEventListener("click", () => { stopped = ""; fire(); if (!playing) api.play(); });
  rest.addEventListener("click", () => { stopped = ""; toRest(); draw(); });
  new IntersectionObserver((entries) => { visible = entries[entries.length - 1].isIntersecting; }).observe(container);
  const api = {
    model, run, wing, where,
    play() { playing = true; play.textContent = "Pause"; play.setAttribute("aria-pressed", "true"); },
    pause() { playing = false; play.textContent = "Play"; play.setAttribute("aria-pressed", "false"); },
    get root() { return root; },
    get settled() { return timer === 0; },
    get playing() { return playing; },
  };
  readings();
  show();
  draw();
  document.addEventListener("themechange", draw);
  requestAnimationFrame(frame);
  return api;
}
