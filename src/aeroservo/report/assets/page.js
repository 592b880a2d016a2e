"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const tip = document.getElementById("tip");
  const SVG = "http://www.w3.org/2000/svg";

  // colours: as the system, dark, light
  const theme = document.getElementById("theme");
  const choices = ["system", "dark", "light"];
  const setTheme = (name) => {
    if (name === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
    theme.textContent = "Colours: " + name;
    try { localStorage.setItem("aeroservo-theme", name); } catch { /* files may have no storage */ }
    document.dispatchEvent(new Event("themechange"));
  };
  let stored = null;
  try { stored = localStorage.getItem("aeroservo-theme"); } catch { /* as above */ }
  if (choices.includes(stored) && stored !== "system") setTheme(stored);
  theme.addEventListener("click", () => {
    const now = document.documentElement.dataset.theme || "system";
    setTheme(choices[(choices.indexOf(now) + 1) % 3]);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => document.dispatchEvent(new Event("themechange")));

  // where the reader is
  const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.getAttribute("href").slice(1), a]));
  const seen = new Set();
  const watch = new IntersectionObserver((entries) => {
    for (const e of entries) e.isIntersecting ? seen.add(e.target.id) : seen.delete(e.target.id);
    const here = [...links.keys()].find((id) => seen.has(id));
    for (const [id, a] of links) id === here ? a.setAttribute("aria-current", "true") : a.removeAttribute("aria-current");
  }, { rootMargin: "-10% 0px -60% 0px" });
  document.querySelectorAll("main > section").forEach((s) => watch.observe(s));

  // comma-separated values
  const cell = (v) => {
    if (v === null || v === undefined) return "";
    let text = String(v);
    if (typeof v === "string" && /^[=+\-@\t\r]/.test(text)) text = "'" + text; // no formula in a spreadsheet
    return /[",\n\r]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
  };
  const save = (name, rows) => {
    const blob = new Blob([rows.map((r) => r.map(cell).join(",")).join("\r\n") + "\r\n"], { type: "text/csv" });
    const a = document.createElement("a");
    a.href = URL.createObjectURL(blob);
    a.download = name + ".csv";
    a.click();
    setTimeout(() => URL.revokeObjectURL(a.href), 5000);
  };
  const chartRows = (chart) => {
    const same = chart.series.every((s) => s.x.length === chart.series[0].x.length && s.x.every((v, i) => v === chart.series[0].x[i]));
    const plain = chart.series.every((s) => !s.along);
    if (same && plain && chart.series.length) {
      const head = [chart.x, ...chart.series.map((s) => `${s.name || "value"} (${chart.y})`)];
      return [head, ...chart.series[0].x.map((x, i) => [x, ...chart.series.map((s) => s.y[i])])];
    }
    const along = [...new Set(chart.series.filter((s) => s.along).map((s) => s.along_label))].join(" / ");
    const head = ["curve", chart.x, chart.y, ...(along ? [along] : [])];
    return [head, ...chart.series.flatMap((s) => s.x.map((x, i) => [s.name, x, s.y[i], ...(along ? [s.along ? s.along[i] : null] : [])]))];
  };
  for (const box of document.querySelectorAll(".table-box")) {
    const t = data.tables[box.dataset.table];
    box.querySelector(".csv").addEventListener("click", () => save(t.file, [t.columns, ...t.rows]));
  }

  // charts: pointing, keys, switching curves
  const number = (v) => (v === null ? "–" : Number(v.toPrecision(5)).toString().replace("-", "−"));
  const axis = (text) => {
    const [low, high, start, end, log] = text.split(",").map(Number);
    const f = log ? Math.log10 : (v) => v;
    return (v) => start + ((f(v) - f(low)) / (f(high) - f(low))) * (end - start);
  };
  for (const box of document.querySelectorAll(".chart-box")) {
    const chart = data.charts[box.dataset.chart], svg = box.querySelector("svg.chart");
    const x = axis(svg.dataset.x), y = axis(svg.dataset.y), cursor = svg.querySelector(".cursor");
    const [left, right] = svg.dataset.x.split(",").slice(2, 4).map(Number);
    const ends = svg.dataset.y.split(",").slice(2, 4).map(Number), top = Math.min(...ends), bottom = Math.max(...ends);
    const off = new Set();
    let at = null; // the curve and point that keys move
    const inside = (a, b) => a >= left - 0.5 && a <= right + 0.5 && b >= top - 0.5 && b <= bottom + 0.5;
    const clear = () => { cursor.replaceChildren(); tip.hidden = true; };
    const draw = (points, text) => {
      cursor.replaceChildren();
      if (!points.length) return clear();
      const path = document.createElementNS(SVG, "path");
      path.setAttribute("d", `M${points[0][0]} ${top}V${bottom}`);
      cursor.append(path);
      for (const [a, b] of points) {
        const c = document.createElementNS(SVG, "circle");
        c.setAttribute("cx", a); c.setAttribute("cy", b); c.setAttribute("r", 3);
        cursor.append(c);
      }
      tip.textContent = text;
      tip.hidden = false;
      const r = svg.getBoundingClientRect(), scale = r.width / svg.viewBox.baseVal.width;
      const px = r.left + points[0][0] * scale, py = r.top + Math.min(...points.map((p) => p[1])) * scale;
      const w = tip.offsetWidth, h = tip.offsetHeight;
      tip.style.left = Math.max(4, px + 14 + w > innerWidth ? px - w - 14 : px + 14) + "px";
      tip.style.top = Math.max(4, Math.min(innerHeight - h - 4, py - h - 8)) + "px";
    };
    const nearest = (px, py, flat) => {
      let best = null, least = Infinity;
      chart.series.forEach((s, k) => {
        if (off.has(k)) return;
        for (let i = 0; i < s.x.length; i++) {
          if (s.x[i] === null || s.y[i] === null) continue;
          const a = x(s.x[i]), b = y(s.y[i]);
          if (!inside(a, b)) continue;
          const d = flat ? Math.abs(a - px) * 1e3 + Math.abs(b - py) : Math.hypot(a - px, b - py);
          if (d < least) { least = d; best = { k, i }; }
        }
      });
      return best;
    };
    const show = (p) => {
      if (!p) return clear();
      at = p;
      const s = chart.series[p.k], px = x(s.x[p.i]);
      if (svg.dataset.hover === "point") {
        const more = s.along ? `\n${s.along_label}: ${number(s.along[p.i])}` : "";
        return draw([[px, y(s.y[p.i])]], `${s.name}\n${chart.x}: ${number(s.x[p.i])}\n${chart.y}: ${number(s.y[p.i])}${more}`);
      }
      const points = [[px, y(s.y[p.i])]], lines = [`${chart.x}: ${number(s.x[p.i])}`, `${s.name || chart.y}: ${number(s.y[p.i])}`];
      chart.series.forEach((other, k) => {
        if (k === p.k || off.has(k) || lines.length > 9) return;
        let best = -1, least = 6;
        for (let i = 0; i < other.x.length; i++) {
          if (other.x[i] === null || other.y[i] === null) continue;
          const d = Math.abs(x(other.x[i]) - px);
          if (d < least && inside(x(other.x[i]), y(other.y[i]))) { least = d; best = i; }
        }
        if (best >= 0) { points.push([x(other.x[best]), y(other.y[best])]); lines.push(`${other.name}: ${number(other.y[best])}`); }
      });
      draw(points, lines.join("\n"));
    };
    svg.addEventListener("pointermove", (e) => {
      const r = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / r.width;
      show(nearest((e.clientX - r.left) * scale, (e.clientY - r.top) * scale, svg.dataset.hover === "x"));
    });
    svg.addEventListener("pointerleave", clear);
    svg.addEventListener("blur", clear);
    svg.addEventListener("keydown", (e) => {
      const steps = { ArrowRight: 1, ArrowLeft: -1, PageDown: 10, PageUp: -10 };
      if (e.key === "Escape") return clear();
      if (!(e.key in steps) && e.key !== "ArrowUp" && e.key !== "ArrowDown") return;
      e.preventDefault();
      const good = (k, i) => chart.series[k].y[i] !== null && chart.series[k].x[i] !== null && !off.has(k)
        && inside(x(chart.series[k].x[i]), y(chart.series[k].y[i]));
      if (!at || off.has(at.k)) return show(nearest(left, bottom, true));
      if (e.key in steps) {
        const n = chart.series[at.k].x.length, way = Math.sign(steps[e.key]);
        let i = Math.max(0, Math.min(n - 1, at.i + steps[e.key]));
        while (i >= 0 && i < n && !good(at.k, i)) i += way;
        if (i >= 0 && i < n) show({ k: at.k, i });
        return;
      }
      const way = e.key === "ArrowDown" ? 1 : -1, m = chart.series.length, here = x(chart.series[at.k].x[at.i]);
      for (let j = 1; j < m; j++) {
        const k = (at.k + way * j + m * j) % m;
        let best = -1, least = Infinity;
        chart.series[k].x.forEach((v, i) => {
          if (good(k, i) && Math.abs(x(v) - here) < least) { least = Math.abs(x(v) - here); best = i; }
        });
        if (best >= 0) return show({ k, i: best });
      }
    });
    for (const button of box.querySelectorAll(".legend button")) {
      button.addEventListener("click", () => {
        const k = Number(button.dataset.k), hide = !off.has(k);
        hide ? off.add(k) : off.delete(k);
        button.setAttribute("aria-pressed", String(!hide));
        svg.querySelector(`.series[data-k="${k}"]`)?.classList.toggle("off", hide);
        clear();
      });
    }
    box.querySelector(".csv").addEventListener("click", () => save(chart.file, chartRows(chart)));
    const larger = box.querySelector(".enlarge");
    larger.addEventListener("click", () => {
      const on = box.classList.toggle("large");
      larger.setAttribute("aria-pressed", String(on));
      larger.textContent = on ? "Smaller" : "Larger";
    });
  }
  window.aeroservoPage = { data, csv: (k) => chartRows(data.charts[k]).map((r) => r.map(cell).join(",")).join("\r\n") };
})();
