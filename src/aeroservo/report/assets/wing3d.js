"use strict";
/* A wing that moves: createWing(container, data) draws the lattice of `report/scene.py` with three.js.

Everything that moves is linear: places = points + scale * sum of value * shape, over the coordinates of the structure
and the angles of the controls. A mode is Re(shape e^(i phase)), a history is values over time, a live simulation sets
the values itself (`setState`). Returns an object with play, pause, seek, select, setSpeed, setScale, setState, dispose
and readings for tests: frames (drawn so far), positions(), time, playing. */
let drawnBySoftware = null;
function bySoftware() { // whether this browser has no graphics card to draw with; asked once
  if (drawnBySoftware === null) {
    const gl = document.createElement("canvas").getContext("webgl2");
    const names = gl && gl.getExtension("WEBGL_debug_renderer_info");
    const name = gl ? String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : "";
    drawnBySoftware = /swiftshader|llvmpipe|softpipe|software/i.test(name);
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return drawnBySoftware;
}
function createWing(container, data, options = {}) {
  const live = Boolean(options.live);
  const names = data.shapes.map((s) => s.name), order = new Map(names.map((n, k) => [n, k]));
  const base = Float32Array.from(data.points), shapes = data.shapes.map((s) => Float32Array.from(s.xyz));
  const count = base.length / 3, modes = data.modes || null, histories = data.histories || [];
  const state = {
    playing: false, frames: 0, scale: data.scale || 1, time: 0, phase: 0, rate: 1, source: null, speed: 0,
    values: new Float32Array(names.length), gust: () => 0, dirty: true, visible: true, alive: true, last: null,
  };

  // what a person handles
  const el = (tag, attributes = {}, ...inner) => {
    const e = document.createElement(tag);
    for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
    e.append(...inner);
    return e;
  };
  const view = el("div", { class: "view" }), readout = el("div", { class: "readout" }), controls = el("div", { class: "controls" });
  container.append(view, controls);
  const slider = (text, min, max, step, value, act, show) => {
    const input = el("input", { type: "range", min, max, step, value, "aria-label": text }), out = el("output");
    const label = el("label", {}, text, input, out);
    const say = () => { out.textContent = show(Number(input.value)); };
    input.addEventListener("input", () => { act(Number(input.value)); say(); });
    say();
    return { label, input, say, set(v) { input.value = v; say(); } };
  };
  const playButton = el("button", { type: "button", class: "play", "aria-pressed": "false" }, "Play");
  const sources = [
    ...(modes ? modes.branches.map((b, k) => ({ kind: "mode", k, name: "Mode: " + b.name })) : []),
    ...histories.map((h, k) => ({ kind: "history", k, name: h.name })),
  ];
  const pick = el("select", { "aria-label": "What is shown" });
  sources.forEach((s, k) => pick.append(new Option(s.name, String(k))));
  const speedSlider = modes && slider("Airspeed", 0, modes.speeds.length - 1, 1, 0, (v) => setSpeed(v), (v) => modes.speeds[v].toPrecision(4) + " m/s");
  const timeSlider = slider("Time", 0, 1000, 1, 0, (v) => { pause(); seek((v / 1000) * duration()); }, () => state.time.toFixed(3) + " s");
  const rateSlider = slider("Speed of play", -2.5, 0.5, 0.05, 0, (v) => { state.rate = 10 ** v; }, (v) => "× " + (10 ** v).toPrecision(2));
  const scaleSlider = slider("Scale of motion", -1, 2, 0.02, Math.log10(state.scale), (v) => setScale(10 ** v), (v) => "× " + (10 ** v).toPrecision(2));
  const growth = el("input", { type: "checkbox" }), growthLabel = el("label", {}, growth, "with growth or decay");
  growth.addEventListener("change", () => { state.phase = 0; state.dirty = true; });
  const camera = el("select", { "aria-label": "Camera" });
  for (const name of ["Camera: free", "from above", "from behind", "from starboard"]) camera.append(new Option(name));
  const reset = el("button", { type: "button" }, "Reset view");
  if (!live && sources.length) {
    controls.append(playButton);
    if (sources.length > 1) controls.append(pick);
    if (modes) controls.append(speedSlider.label, growthLabel);
    controls.append(timeSlider.label, rateSlider.label);
  }
  if (names.length) controls.append(scaleSlider.label);
  controls.append(camera, reset);

  // the picture
  let renderer = null, ratio = bySoftware() ? 0.75 : Math.min(devicePixelRatio || 1, 1.5);
  try {
    const canvas = document.createElement("canvas"); // opaque and square: with blending or round corners a page drawn
    const context = canvas.getContext("webgl2", { alpha: false, antialias: !bySoftware(), stencil: false }); // by software halves its rate
    renderer = new THREE.WebGLRenderer({ canvas, context });
  } catch {
    view.append(el("p", { class: "no-view" }, "This browser draws no WebGL, so the three-dimensional view is left out."));
  }
  view.append(readout);
  const scene = new THREE.Scene(), eye = new THREE.PerspectiveCamera(32, 1.6, 0.01, 1000);
  eye.up.set(0, 0, 1);
  const index = { wing: [], control: [], other: [] }, lines = [];
  for (const p of data.patches) {
    const at = (i, j) => p.start + i * p.cols + j;
    for (let i = 0; i < p.rows; i++) for (let j = 0; j < p.cols; j++) {
      if (i + 1 < p.rows && j + 1 < p.cols) index[p.kind].push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
      if (i + 1 < p.rows) lines.push(at(i, j), at(i + 1, j));
      if (j + 1 < p.cols) lines.push(at(i, j), at(i, j + 1));
    }
  }
  const position = new THREE.BufferAttribute(Float32Array.from(base), 3);
  position.setUsage(THREE.DynamicDrawUsage);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", position);
  geometry.setIndex([...index.wing, ...index.control, ...index.other]);
  let from = 0;
  ["wing", "control", "other"].forEach((kind, k) => { geometry.addGroup(from, index[kind].length, k); from += index[kind].length; });
  const paint = (extra) => new THREE.MeshLambertMaterial({ side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...extra });
  const materials = [paint({}), paint({}), paint({})];
  const mesh = new THREE.Mesh(geometry, materials);
  const edges = new THREE.BufferGeometry();
  edges.setAttribute("position", position);
  edges.setIndex(lines);
  const wire = new THREE.LineSegments(edges, new THREE.LineBasicMaterial(bySoftware() ? {} : { transparent: true, opacity: 0.55 }));
  const restGeometry = new THREE.BufferGeometry();
  restGeometry.setAttribute("position", new THREE.BufferAttribute(base, 3));
  restGeometry.setIndex(outline());
  const rest = new THREE.LineSegments(restGeometry, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.5 }));
  mesh.frustumCulled = wire.frustumCulled = false;
  scene.add(mesh, wire, rest, new THREE.HemisphereLight(0xffffff, 0x8899aa, 2.2));
  const sun = new THREE.DirectionalLight(0xffffff, 1.6);
  sun.position.set(-2, -1, 4);
  scene.add(sun);

  // the gust: a sheet whose height is the upward velocity, moving aft with the air
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < base.length; i++) { low[i % 3] = Math.min(low[i % 3], base[i]); high[i % 3] = Math.max(high[i % 3], base[i]); }
  const size = Math.max(high[0] - low[0], high[1] - low[1]), middle = low.map((v, k) => 0.5 * (v + high[k]));
  const columns = 65, rows = 7, reach = 1.6 * size;
  const air = new Float32Array(columns * rows * 3), airLines = [], airFaces = [];
  for (let i = 0; i < columns; i++) for (let j = 0; j < rows; j++) {
    const k = i * rows + j;
    air[3 * k] = middle[0] - reach + (2 * reach * i) / (columns - 1);
    air[3 * k + 1] = low[1] + ((high[1] - low[1]) * j) / (rows - 1);
    if (i + 1 < columns && j + 1 < rows) airFaces.push(k, k + rows, k + rows + 1, k, k + rows + 1, k + 1);
    if (i + 1 < columns) airLines.push(k, k + rows);
    if (j + 1 < rows && i % 4 === 0) airLines.push(k, k + 1);
  }
  const airGeometry = new THREE.BufferGeometry(), airEdges = new THREE.BufferGeometry();
  const airPosition = new THREE.BufferAttribute(air, 3);
  airGeometry.setAttribute("position", airPosition);
  airGeometry.setIndex(airFaces);
  airEdges.setAttribute("position", airPosition);
  airEdges.setIndex(airLines);
  const sheet = new THREE.Group();
  const sheetPaint = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true, opacity: 0.12, depthWrite: false });
  const sheetLine = new THREE.LineBasicMaterial(bySoftware() ? {} : { transparent: true, opacity: 0.45 });
  const a = new THREE.Mesh(airGeometry, sheetPaint), b = new THREE.LineSegments(airEdges, sheetLine);
  a.frustumCulled = b.frustumCulled = false;
  sheet.add(b);
  if (!bySoftware()) sheet.add(a); // a large transparent face costs a software renderer a quarter of its frames
  sheet.visible = false;
  scene.add(sheet);
  let gustGain = 0, gustAt = () => 0, gustSpeed = 1;

  function outline() {
    const pairs = [];
    for (const p of data.patches) {
      const at = (i, j) => p.start + i * p.cols + j;
      for (let i = 0; i + 1 < p.rows; i++) pairs.push(at(i, 0), at(i + 1, 0), at(i, p.cols - 1), at(i + 1, p.cols - 1));
      for (let j = 0; j + 1 < p.cols; j++) pairs.push(at(0, j), at(0, j + 1), at(p.rows - 1, j), at(p.rows - 1, j + 1));
    }
    return pairs;
  }
  const colours = () => {
    const style = getComputedStyle(container), of = (name, other) => new THREE.Color((style.getPropertyValue(name) || other).trim() || other);
    materials[0].color = of("--wing", "#3a94c9");
    materials[1].color = of("--c1", "#e69f00");
    materials[2].color = of("--line", "#cccccc");
    wire.material.color = of("--ink", "#222222");
    rest.material.color = of("--soft", "#777777");
    sheetPaint.color = of("--c2", "#009e73");
    sheetLine.color = of("--c2", "#009e73");
    scene.background = of("--panel", "#f6f7f9");
    state.dirty = true;
  };

  // camera
  let orbit = null;
  const look = (which) => {
    const far = 1.08 * size + (high[2] - low[2]);
    const from = [[-0.95, -0.85, 0.62], [-0.001, 0, 1.15], [1.15, 0, 0.12], [0, 1.15, 0.12]][which];
    const narrow = Math.max(1, 1.5 / eye.aspect);
    eye.position.set(middle[0] + far * narrow * from[0], middle[1] + far * narrow * from[1], middle[2] + far * narrow * from[2]);
    if (orbit) { orbit.target.set(...middle); orbit.update(); } else eye.lookAt(...middle);
    state.dirty = true;
  };
  const resize = () => {
    const w = Math.max(view.clientWidth, 10), h = Math.max(view.clientHeight, 10);
    eye.aspect = w / h;
    eye.near = size / 100;
    eye.far = 40 * size;
    eye.updateProjectionMatrix();
    renderer?.setSize(w, h, false);
    if (renderer && orbit) { pose(); renderer.render(scene, eye); } // at once: a new size begins black
    state.dirty = true;
  };
  if (renderer) {
    renderer.setPixelRatio(ratio);
    const canvas = renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "Wing in three dimensions: arrow keys turn it, plus and minus come nearer and go away, space plays");
    view.prepend(canvas);
    orbit = new THREE.OrbitControls(eye, canvas);
    orbit.enableDamping = false;
    orbit.addEventListener("change", () => { state.dirty = true; });
    canvas.addEventListener("keydown", (e) => {
      const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08] }[e.key];
      const zoom = { "+": 0.9, "=": 0.9, "-": 1.1 }[e.key];
      if (e.key === " ") { e.preventDefault(); toggle(); }
      if (!turn && !zoom) return;
      e.preventDefault();
      const d = eye.position.clone().sub(orbit.target), r = d.length() * (zoom || 1);
      const angle = Math.atan2(d.y, d.x) + (turn ? turn[0] : 0);
      const rise = Math.max(-1.5, Math.min(1.5, Math.asin(d.z / d.length()) + (turn ? turn[1] : 0)));
      eye.position.set(r * Math.cos(rise) * Math.cos(angle), r * Math.cos(rise) * Math.sin(angle), r * Math.sin(rise)).add(orbit.target);
      orbit.update();
      state.dirty = true;
    });
  }
  camera.addEventListener("change", () => look(camera.selectedIndex));
  reset.addEventListener("click", () => { camera.selectedIndex = 0; look(0); });

  // what is shown
  const duration = () => {
    if (!state.source) return 1;
    if (state.source.kind === "history") { const t = histories[state.source.k].t; return t[t.length - 1] - t[0]; }
    const f = Math.abs(modes.branches[state.source.k].omega[state.speed] || 0);
    return f > 0 ? (2 * Math.PI) / f : 1;
  };
  const interpolate = (t, values, at) => {
    let lo = 0, hi = t.length - 1;
    if (at <= t[0]) return values[0];
    if (at >= t[hi]) return values[hi];
    while (hi - lo > 1) { const m = (lo + hi) >> 1; t[m] <= at ? (lo = m) : (hi = m); }
    const f = (at - t[lo]) / (t[hi] - t[lo]);
    return values[lo] + f * (values[hi] - values[lo]);
  };
  function pose() {
    const v = state.values;
    if (state.source?.kind === "mode") {
      const b = modes.branches[state.source.k], s = b.shape[state.speed] || [], w = b.omega[state.speed] || 0;
      const angle = w ? state.phase : 0.5 * Math.PI * Math.sin(state.phase);
      const size = growth.checked && w ? Math.exp(Math.max(-3, Math.min(1.5, (b.growth[state.speed] / Math.abs(w)) * state.phase))) : 1;
      v.fill(0);
      for (let j = 0; j < s.length / 2; j++) v[j] = size * (w ? s[2 * j] * Math.cos(angle) - s[2 * j + 1] * Math.sin(angle) : s[2 * j] * Math.sin(state.phase));
      state.time = w ? (state.phase % (2 * Math.PI)) / Math.abs(w) : 0;
      const z = b.damping[state.speed], text = w ? `${(Math.abs(w) / 2 / Math.PI).toPrecision(4)} Hz` : "does not oscillate";
      said = b.omega[state.speed] === null ? `${b.name}: no root at this speed`
        : `${b.name} at ${modes.speeds[state.speed].toPrecision(4)} m/s\n${text}, damping ratio ${z === null ? "–" : z.toPrecision(3)}${z < 0 ? " (unstable)" : ""}`;
    } else if (state.source?.kind === "history") {
      const h = histories[state.source.k], at = h.t[0] + state.time;
      for (const [name, values] of Object.entries(h.values)) if (order.has(name)) v[order.get(name)] = interpolate(h.t, values, at);
      const lines = [`t = ${at.toFixed(3)} s`];
      for (const r of h.readings || []) lines.push(`${r.name} ${(interpolate(h.t, r.values, at)).toPrecision(4)} ${r.unit}`);
      said = lines.join("\n");
    }
    const p = position.array;
    p.set(base);
    for (let k = 0; k < v.length; k++) {
      const f = v[k] * state.scale, s = shapes[k];
      if (f !== 0) for (let i = 0; i < p.length; i++) p[i] += f * s[i];
    }
    position.needsUpdate = true;
    if (renderer) geometry.computeVertexNormals();
    if (sheet.visible) {
      const now = live ? state.time : (state.source?.kind === "history" ? histories[state.source.k].t[0] + state.time : 0);
      for (let i = 0; i < columns; i++) {
        const x = air[3 * i * rows], z = low[2] - 0.12 * size + gustGain * gustAt(now - (x - low[0]) / gustSpeed);
        for (let j = 0; j < rows; j++) air[3 * (i * rows + j) + 2] = z;
      }
      airPosition.needsUpdate = true;
    }
  }
  // texts and sliders follow eight times a second: each costs a repaint of the page around the picture
  let said = "", told = 0;
  function tell(now, force) {
    if (live || (!force && now - told < 125)) return;
    told = now;
    if (readout.textContent !== said) readout.textContent = said;
    timeSlider.set(Math.round((1000 * state.time) / duration()));
  }
  function showGust(at, speed, strongest) {
    gustAt = at;
    gustSpeed = speed;
    gustGain = strongest > 0 ? (0.16 * size) / strongest : 0;
    sheet.visible = strongest > 0;
    state.dirty = true;
  }
  function select(k) {
    state.source = sources[k] || null;
    pick.selectedIndex = k;
    state.values.fill(0);
    state.time = state.phase = 0;
    const isMode = state.source?.kind === "mode";
    if (modes) { speedSlider.label.hidden = !isMode; growthLabel.hidden = !isMode; }
    if (state.source?.kind === "history") {
      const h = histories[state.source.k];
      state.rate = h.rate || 1;
      if (h.scale) setScale(h.scale);
      const strongest = h.gust ? Math.max(...h.gust.map(Math.abs)) : 0;
      showGust((t) => (t < h.t[0] ? 0 : interpolate(h.t, h.gust, t)), h.speed || 1, strongest);
    } else {
      sheet.visible = false;
      if (isMode) { setSpeed(state.speed); setScale(1); }
    }
    rateSlider.set(Math.log10(state.rate));
    state.dirty = true;
  }
  function setSpeed(k) {
    state.speed = Math.max(0, Math.min(modes.speeds.length - 1, Math.round(k)));
    speedSlider.set(state.speed);
    if (state.source?.kind === "mode") {
      const f = Math.abs(modes.branches[state.source.k].omega[state.speed] || 0) / (2 * Math.PI);
      state.rate = f > 0 ? Math.min(3, 0.7 / f) : 1; // 0.7 cycles a second on the screen
      rateSlider.set(Math.log10(state.rate));
    }
    state.dirty = true;
  }
  function setScale(v) { state.scale = v; scaleSlider.input.value = Math.log10(v); scaleSlider.say(); state.dirty = true; }
  function seek(t) {
    if (state.source?.kind === "mode") { const w = Math.abs(modes.branches[state.source.k].omega[state.speed] || 0); state.phase = w ? t * w : 2 * Math.PI * t; }
    state.time = t;
    state.dirty = true;
  }
  function play() {
    state.playing = true;
    state.last = null;
    playButton.textContent = "Pause";
    playButton.setAttribute("aria-pressed", "true");
  }
  function pause() {
    state.playing = false;
    playButton.textContent = "Play";
    playButton.setAttribute("aria-pressed", "false");
  }
  function toggle() { state.playing ? pause() : play(); }
  playButton.addEventListener("click", toggle);
  pick.addEventListener("change", () => select(pick.selectedIndex));

  let slow = 0;
  function frame(now) {
    if (!state.alive) return;
    requestAnimationFrame(frame);
    if (!state.visible) { state.last = null; return; }
    if (state.playing && !live) {
      const step = state.last === null ? 0 : Math.min(0.1, (now - state.last) / 1000);
      if (state.last !== null && renderer) { // coarser pixels rather than fewer frames
        slow = now - state.last > 34 ? slow + 1 : Math.max(0, slow - 1);
        if (slow > 12 && ratio > 0.6) { ratio *= 0.8; renderer.setPixelRatio(ratio); resize(); slow = 0; }
      }
      if (state.source?.kind === "mode") {
        const w = Math.abs(modes.branches[state.source.k].omega[state.speed] || 0) || 2 * Math.PI;
        state.phase += step * state.rate * w;
        if (growth.checked && state.phase > 8 * Math.PI) state.phase = 0;
      } else if (state.source) {
        state.time += step * state.rate;
        if (state.time > duration()) state.time = 0;
      }
      state.dirty = true;
    }
    state.last = now;
    if (!state.dirty) return;
    state.dirty = false;
    pose();
    tell(now, !state.playing);
    renderer?.render(scene, eye);
    state.frames += 1;
  }
  const watch = new IntersectionObserver((entries) => { state.visible = entries[entries.length - 1].isIntersecting; state.dirty = true; });
  watch.observe(view);
  const sized = new ResizeObserver(resize);
  sized.observe(view);
  document.addEventListener("themechange", colours);
  const printed = () => { if (renderer) { pose(); renderer.render(scene, eye); } };
  addEventListener("beforeprint", printed);
  colours();
  resize();
  look(0);
  if (!live && sources.length) select(options.select || 0);
  if (modes && !live) setSpeed(modes.start || 0);
  if (renderer) { pose(); renderer.render(scene, eye); } // paper and pictures wait for no frame
  requestAnimationFrame(frame);
  return {
    element: container, names, readout,
    play, pause, toggle, select, setSpeed, setScale, seek, showGust,
    setState(values, time) { state.values.set(values); state.time = time ?? state.time; state.dirty = true; },
    positions: () => Array.from(position.array),
    get frames() { return state.frames; },
    get time() { return state.time; },
    get playing() { return state.playing; },
    get count() { return count; },
    get webgl() { return renderer !== null; },
    dispose() {
      state.alive = false;
      watch.disconnect();
      sized.disconnect();
      document.removeEventListener("themechange", colours);
      removeEventListener("beforeprint", printed);
      renderer?.dispose();
      container.replaceChildren();
    },
  };
}
if (typeof window !== "undefined") window.createWing = createWing;
