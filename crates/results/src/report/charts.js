"use strict";
// Makes charts that can be zoomed out of those that are in the page. A chart is a function of what part of its horizontal axis
// is shown; the vertical axis always fits what is to be seen.
(() => {
  const NS = "http://www.w3.org/2000/svg";
  const LEFT = 66, RIGHT = 12, TOP = 10, BOTTOM = 42;
  const HINT = "Drag to zoom, double click for all; click into a chart to zoom with the wheel.";

  const element = (name, attributes, text) => {
    const made = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };

  // Round values between two others, about so many.
  const ticks = (low, high, count) => {
    const rough = (high - low) / count;
    if (!(rough > 0)) return [];
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = ([1, 2, 5].find((s) => s * power >= rough) ?? 10) * power;
    const all = [];
    for (let k = Math.ceil(low / step); k * step <= high; k++) all.push(k * step);
    return all;
  };

  // As many digits as tell neighbours on an axis apart.
  const said = (value, length) => {
    if (value === 0 || Math.abs(value) < 1e-9 * length) return "0";
    const digits = Math.max(3, Math.min(9, Math.ceil(Math.log10(Math.abs(value) / length)) + 3));
    const rounded = Number(value.toPrecision(digits));
    const size = Math.abs(rounded);
    if (size < 1e-3 || size >= 1e6) return rounded.toExponential().replace("e+", "e");
    const [whole, ...rest] = String(rounded).split(".");
    return [whole.replace(/\B(?=(\d{3})+$)/g, ","), ...rest].join(".");
  };

  const extent = (values, margin) => {
    let low = Infinity, high = -Infinity;
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    if (!(high >= low)) return [0, 1];
    const more = high > low ? margin * (high - low) : 0.5 * Math.max(Math.abs(high), 1);
    return [low - more, high + more];
  };

  // The place of the first value that is not below x, in ascending values.
  const place = (values, x) => {
    let low = 0, high = values.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (values[middle] < x) low = middle + 1; else high = middle;
    }
    return low;
  };

  class Chart {
    static count = 0;

    constructor(figure) {
      this.figure = figure;
      const data = JSON.parse(figure.querySelector("script").textContent);
      Object.assign(this, data);
      let times = [];
      for (const line of this.lines) {
        times = line.x ??= times;
        line.ascends = line.x.every((x, k) => k === 0 || line.x[k - 1] <= x);
        line.shown = true;
      }
      this.svg = figure.querySelector("svg");
      this.svg.setAttribute("tabindex", "0");
      this.readout = document.createElement("div");
      this.readout.className = "readout";
      this.readout.hidden = true;
      figure.append(this.readout);
      this.whole();
      this.key();
      this.listen();
    }

    whole() {
      this.range = extent(this.lines.flatMap((line) => line.x), 0.02);
      this.full = [...this.range];
    }

    // Names of lines switch them off and on.
    key() {
      this.figure.querySelectorAll(".key li").forEach((item, k) => {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = item.textContent;
        button.setAttribute("aria-pressed", "true");
        button.onclick = () => {
          const line = this.lines[k];
          line.shown = !line.shown;
          item.classList.toggle("off", !line.shown);
          button.setAttribute("aria-pressed", String(line.shown));
          this.draw();
        };
        item.replaceChildren(button);
      });
    }

    lifted(value) {
      return this.log ? Math.log10(value) : value;
    }

    across(x) {
      return LEFT + (x - this.range[0]) / (this.range[1] - this.range[0]) * (this.width - LEFT - RIGHT);
    }

    down(y) {
      return this.height - BOTTOM - (y - this.low) / (this.high - this.low) * (this.height - TOP - BOTTOM);
    }

    value(pixel) {
      const share = (pixel - LEFT) / (this.width - LEFT - RIGHT);
      return this.range[0] + Math.min(1, Math.max(0, share)) * (this.range[1] - this.range[0]);
    }

    // Points of a line that are to be seen, and one more on each side.
    seen(line) {
      if (!line.ascends) return line.x.map((_, k) => k);
      const first = Math.max(0, place(line.x, this.range[0]) - 1);
      const last = Math.min(line.x.length - 1, place(line.x, this.range[1]));
      const all = [];
      for (let k = first; k <= last; k++) all.push(k);
      return all;
    }

    draw() {
      this.width = Math.max(240, this.svg.clientWidth);
      this.height = Math.round(Math.min(340, Math.max(230, 0.5 * this.width)));
      const { svg, width, height } = this;
      svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      const lines = this.lines.map((line, k) => ({ ...line, k })).filter((line) => line.shown);
      const inside = (line, k) => line.x[k] >= this.range[0] && line.x[k] <= this.range[1];
      const seen = lines.map((line) => this.seen(line));
      let values = lines.flatMap((line, n) => seen[n].filter((k) => inside(line, k)).map((k) => this.lifted(line.y[k])));
      if (values.length < 2) values = lines.flatMap((line, n) => seen[n].map((k) => this.lifted(line.y[k])));
      [this.low, this.high] = extent(values, 0.05);

      const grid = element("g", { class: "grid" });
      const right = width - RIGHT, bottom = height - BOTTOM;
      for (const tick of ticks(...this.range, Math.max(2, Math.floor(width / 90)))) {
        const x = this.across(tick);
        grid.append(element("path", { d: `M${x} ${TOP}V${bottom}` }));
        const text = said(tick, this.range[1] - this.range[0]);
        grid.append(element("text", { x, y: bottom + 16, "text-anchor": "middle" }, text));
      }
      for (const tick of ticks(this.low, this.high, 5)) {
        const y = this.down(tick);
        // Between whole powers of ten a logarithmic axis says what a line is worth.
        const text = this.log ? said(10 ** tick, 10 ** tick) : said(tick, this.high - this.low);
        grid.append(element("path", { d: `M${LEFT} ${y}H${right}` }));
        grid.append(element("text", { x: LEFT - 6, y: y + 4, "text-anchor": "end" }, text));
      }
      const titles = [
        element("text", { class: "title", x: 0.5 * (LEFT + right), y: height - 6, "text-anchor": "middle" }, this.x),
        element("text", {
          class: "title",
          transform: `translate(13 ${0.5 * (TOP + bottom)}) rotate(-90)`,
          "text-anchor": "middle",
        }, this.y),
      ];
      this.clip ??= `clip${Chart.count++}`;
      const clip = element("clipPath", { id: this.clip });
      clip.append(element("rect", { x: LEFT, y: TOP, width: right - LEFT, height: bottom - TOP }));
      const drawn = element("g", { "clip-path": `url(#${this.clip})` });
      lines.forEach((line, n) => {
        const points = seen[n].map((k) => `${this.across(line.x[k]).toFixed(1)},${this.down(this.lifted(line.y[k])).toFixed(1)}`);
        const dashed = line.dashed ? " dashed" : "";
        drawn.append(element("polyline", { class: `line c${line.k % 8}${dashed}`, points: points.join(" ") }));
      });
      this.over = element("g", {});
      svg.replaceChildren(clip, grid, ...titles, drawn, this.over);
    }

    zoom(low, high) {
      const least = 1e-6 * (this.full[1] - this.full[0]);
      if (high - low < least) return;
      this.range = [Math.max(low, this.full[0]), Math.min(high, this.full[1])];
      this.readout.hidden = true;
      this.draw();
    }

    // What lines are worth where the pointer is.
    point(x, y) {
      this.over.replaceChildren();
      const told = [];
      let marked = null;
      for (const [n, line] of this.lines.entries()) {
        if (!line.shown) continue;
        const k = line.ascends ? this.near(line, this.value(x)) : this.nearest(line, x, y);
        if (k === undefined) continue;
        marked ??= line.x[k];
        const dot = { class: `dot c${n % 8}`, cx: this.across(line.x[k]), cy: this.down(this.lifted(line.y[k])), r: 3.5 };
        this.over.append(element("circle", dot));
        const name = this.lines.length > 1 ? `${line.name}: ` : "";
        const at = line.ascends ? "" : ` at ${said(line.x[k], Math.abs(line.x[k]))}`;
        told.push(name + said(line.y[k], Math.abs(line.y[k]) / 10) + at);
      }
      if (marked === null) return;
      const at = this.across(marked);
      this.over.prepend(element("path", { class: "cursor", d: `M${at} ${TOP}V${this.height - BOTTOM}` }));
      this.readout.textContent = [`${this.x}: ${said(marked, Math.abs(marked) / 10)}`, ...told].join("\n");
      this.readout.hidden = false;
      const box = this.svg.getBoundingClientRect(), around = this.figure.getBoundingClientRect();
      const room = around.width - this.readout.offsetWidth - 4;
      const beside = at > 0.5 * this.width ? at - this.readout.offsetWidth - 12 : at + 24;
      this.readout.style.left = `${Math.max(4, Math.min(room, box.left - around.left + beside))}px`;
      this.readout.style.top = `${box.top - around.top + TOP}px`;
    }

    near(line, x) {
      const after = place(line.x, x);
      const choice = [after - 1, after].filter((k) => k >= 0 && k < line.x.length);
      return choice.sort((a, b) => Math.abs(line.x[a] - x) - Math.abs(line.x[b] - x))[0];
    }

    nearest(line, x, y) {
      let best, least = Infinity;
      line.x.forEach((at, k) => {
        const distance = (this.across(at) - x) ** 2 + (this.down(this.lifted(line.y[k])) - y) ** 2;
        if (distance < least) [best, least] = [k, distance];
      });
      return best;
    }

    listen() {
      const { svg } = this;
      let from = null;
      const spot = (event) => {
        const box = svg.getBoundingClientRect();
        return [(event.clientX - box.left) * this.width / box.width, (event.clientY - box.top) * this.height / box.height];
      };
      svg.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        [from] = spot(event);
        svg.focus({ preventScroll: true });
        svg.setPointerCapture(event.pointerId);
      });
      svg.addEventListener("pointermove", (event) => {
        const [x, y] = spot(event);
        if (from === null) return this.point(x, y);
        this.readout.hidden = true;
        const [low, high] = [from, x].sort((a, b) => a - b);
        const size = { x: low, y: TOP, width: high - low, height: this.height - TOP - BOTTOM };
        this.over.replaceChildren(element("rect", { class: "chosen", ...size }));
      });
      svg.addEventListener("pointerup", (event) => {
        if (from === null) return;
        const [x] = spot(event);
        const [low, high] = [from, x].sort((a, b) => a - b);
        from = null;
        this.over.replaceChildren();
        if (high - low > 6) this.zoom(this.value(low), this.value(high));
      });
      svg.addEventListener("pointercancel", () => {
        from = null;
        this.over.replaceChildren();
      });
      svg.addEventListener("pointerleave", () => {
        if (from !== null) return;
        this.readout.hidden = true;
        this.over.replaceChildren();
      });
      svg.addEventListener("dblclick", () => this.zoom(...this.full));
      svg.addEventListener("keydown", (event) => {
        if (event.key === "Escape") this.zoom(...this.full);
      });
      // The wheel belongs to the page until somebody has turned to the chart.
      svg.addEventListener("wheel", (event) => {
        if (document.activeElement !== svg && !event.ctrlKey) return;
        event.preventDefault();
        const middle = this.value(spot(event)[0]);
        const factor = event.deltaY < 0 ? 0.8 : 1.25;
        this.zoom(middle - factor * (middle - this.range[0]), middle + factor * (this.range[1] - middle));
      }, { passive: false });
    }
  }

  const charts = [...document.querySelectorAll("figure.chart")].map((figure) => new Chart(figure));
  const all = () => charts.forEach((chart) => chart.draw());
  all();
  let waiting = 0;
  addEventListener("resize", () => {
    cancelAnimationFrame(waiting);
    waiting = requestAnimationFrame(all);
  });
  addEventListener("beforeprint", all);
  if (charts.length > 0) {
    const hint = document.createElement("p");
    hint.className = "note";
    hint.textContent = HINT;
    document.querySelector("nav").after(hint);
  }
  // A picture takes the whole width when it is clicked.
  document.querySelectorAll(".pictures img").forEach((image) => {
    image.addEventListener("click", () => image.closest("figure").classList.toggle("large"));
  });
  document.documentElement.dataset.charts = String(charts.length);
})();
