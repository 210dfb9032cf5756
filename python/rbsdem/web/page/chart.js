// Figures as in a paper: a thin frame, ticks inward on all sides, lines, bands and marks in plain SVG.

import { shown } from "./units.js";

const NS = "http://www.w3.org/2000/svg";

export function svgElement(name, attributes = {}, ...children) {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) if (value !== null) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

export function niceTicks(low, high, most) {
  const span = high - low || 1, raw = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].find(s => s * power >= raw * 0.999) * power;
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * span; i++) ticks.push(i * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9) + (step / power === 2.5 ? 1 : 0));
  return { ticks, text: v => (Math.abs(v) < 1e-12 * step ? 0 : v).toFixed(Math.min(digits, 8)).replace("-", "−") };
}

function extent(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const v of list) {
    if (v === null || !Number.isFinite(v)) continue;
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return low > high ? [0, 1] : [low, high];
}

function pathOf(x, y, toX, toY) {
  let text = "", pen = "M";
  for (let i = 0; i < x.length; i++) {
    if (x[i] === null || y[i] === null) { pen = "M"; continue; }
    text += pen + toX(x[i]).toFixed(1) + " " + toY(y[i]).toFixed(1);
    pen = "L";
  }
  return text;
}

const MARKS = {
  circle: "M-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0Z",
  square: "M-3.2 -3.2H3.2V3.2H-3.2Z",
  diamond: "M0 -4.4L4.4 0L0 4.4L-4.4 0Z",
  triangle: "M0 -4.4L4 3.2H-4Z",
  cross: "M-3.4 -3.4L3.4 3.4M-3.4 3.4L3.4 -3.4",
};

// The sign of a mark beside a text.
export function markSign(shape, filled, kind) {
  return svgElement("svg", { viewBox: "-6 -6 12 12", width: 11, height: 11, class: `sign mark ${kind}`, "aria-hidden": "true" }, svgElement("path", { d: MARKS[shape] ?? MARKS.circle, class: filled ? "filled" : "open" }));
}

// spec: lines [{x, y, kind, label}], bands [{x, lower, upper, kind}], marks [{x, y, shape, kind, text}],
// xLabel, yLabel, symmetric, zero (axes through zero), label (for who does not see it), top (a second scale of x),
// legend (beneath the figure: lines and marks that have a label)
export function drawChart(host, spec) {
  const width = Math.max(240, host.clientWidth || 420), legend = legendOf(spec, width - 58), under = 17 * legend.rows;
  const height = (spec.height ?? Math.round(Math.min(0.78 * width, 460))) + under;
  const room = { left: 58, right: 14, top: spec.top ? 34 : 12, bottom: 44 + under };
  const inner = [width - room.left - room.right, height - room.top - room.bottom];
  const xs = [...spec.lines.map(l => l.x), ...(spec.marks ?? []).map(m => [m.x])];
  const ys = [...spec.lines.map(l => l.y), ...(spec.bands ?? []).flatMap(b => [b.lower, b.upper]), ...(spec.marks ?? []).map(m => [m.y])];
  let [x0, x1] = extent(xs), [y0, y1] = extent(ys);
  if (spec.symmetric) { x1 = Math.max(-x0, x1); x0 = -x1; y1 = Math.max(-y0, y1); y0 = -y1; }
  if (spec.fromZero) { x0 = Math.min(0, x0); y0 = Math.min(0, y0); }
  if (x0 === x1) x1 = x0 + 1;
  if (y0 === y1) y1 = y0 + 1;
  const px = 0.05 * (x1 - x0), py = 0.06 * (y1 - y0);
  if (!(spec.fromZero && x0 === 0)) x0 -= px;
  if (!(spec.fromZero && y0 === 0)) y0 -= py;
  x1 += px; y1 += py;
  const toX = v => room.left + (v - x0) / (x1 - x0) * inner[0];
  const toY = v => room.top + inner[1] - (v - y0) / (y1 - y0) * inner[1];
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", class: "chart", "aria-label": spec.label });
  const left = room.left, top = room.top, right = left + inner[0], bottom = top + inner[1];
  const axis = svgElement("g", { class: "axis" });
  if (spec.zero) axis.append(svgElement("path", { class: "zero", d:
    (y0 < 0 && y1 > 0 ? `M${left} ${toY(0).toFixed(1)}H${right}` : "") + (x0 < 0 && x1 > 0 ? `M${toX(0).toFixed(1)} ${top}V${bottom}` : "") }));
  const tx = niceTicks(x0, x1, inner[0] / 62), ty = niceTicks(y0, y1, inner[1] / 42);
  let ticks = "";
  for (const v of tx.ticks) {
    const x = toX(v).toFixed(1);
    ticks += `M${x} ${bottom}v-4` + (spec.top ? "" : `M${x} ${top}v4`);
    axis.append(svgElement("text", { x, y: bottom + 15, "text-anchor": "middle" }, tx.text(v)));
  }
  for (const v of ty.ticks) {
    const y = toY(v);
    ticks += `M${left} ${y.toFixed(1)}h4M${right} ${y.toFixed(1)}h-4`;
    axis.append(svgElement("text", { x: left - 6, y: (y + 4).toFixed(1), "text-anchor": "end" }, ty.text(v)));
  }
  if (spec.top) {
    const scale = spec.top.factor, tt = niceTicks(x0 * scale, x1 * scale, inner[0] / 70);
    for (const v of tt.ticks) {
      const x = toX(v / scale).toFixed(1);
      ticks += `M${x} ${top}v4`;
      axis.append(svgElement("text", { x, y: top - 5, "text-anchor": "middle" }, tt.text(v)));
    }
    axis.append(svgElement("text", { class: "axislabel", x: right, y: 11, "text-anchor": "end" }, spec.top.label));
  }
  axis.append(svgElement("path", { class: "frame", d: ticks + `M${left} ${top}H${right}V${bottom}H${left}Z` }));
  axis.append(svgElement("text", { class: "axislabel", x: (left + right) / 2, y: bottom + 36, "text-anchor": "middle" }, spec.xLabel));
  axis.append(svgElement("text", { class: "axislabel", x: 0, y: 0, "text-anchor": "middle", transform: `translate(13 ${((top + bottom) / 2).toFixed(1)}) rotate(-90)` }, spec.yLabel));
  svg.append(axis);
  const plot = svgElement("g", { class: "plot" });
  for (const band of spec.bands ?? []) {
    const areas = svgElement("g", { class: `band ${band.kind}` });
    // Between two turning points the band is one area; over the whole path they lie on each other.
    for (const [from, to] of turns(band.x)) {
      let d = "";
      for (let i = from; i <= to; i++) d += (d ? "L" : "M") + toX(band.x[i]).toFixed(1) + " " + toY(band.upper[i]).toFixed(1);
      for (let i = to; i >= from; i--) d += "L" + toX(band.x[i]).toFixed(1) + " " + toY(band.lower[i]).toFixed(1);
      areas.append(svgElement("path", { d: d + "Z" }));
    }
    plot.append(areas);
  }
  for (const line of spec.lines) plot.append(svgElement("path", { class: `line ${line.kind}`, d: pathOf(line.x, line.y, toX, toY) }));
  for (const mark of spec.marks ?? []) {
    const x = toX(mark.x), y = toY(mark.y);
    const g = svgElement("g", { class: `mark ${mark.kind ?? ""}`, transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})` },
      svgElement("path", { d: MARKS[mark.shape] ?? MARKS.circle, class: mark.filled ? "filled" : "open" }));
    if (mark.title) g.append(svgElement("title", {}, mark.title));
    if (mark.text) {
      const end = x > right - 60;
      g.append(svgElement("text", { x: end ? -7 : 7, y: 4, "text-anchor": end ? "end" : "start" }, mark.text));
    }
    plot.append(g);
  }
  svg.append(plot);
  legend.group.setAttribute("transform", `translate(${left} ${bottom + 55})`);
  svg.append(legend.group);
  const cursor = svgElement("g", { class: "cursor", visibility: "hidden" }, svgElement("path", { d: MARKS.circle }));
  svg.append(cursor);
  svg.append(probeOf(svg, spec, { toX, toY, left, right, top }));
  host.replaceChildren(svg);
  SPECS.set(svg, spec);
  return { svg, toX, toY, moveCursor(x, y) {
    cursor.setAttribute("visibility", "visible");
    cursor.setAttribute("transform", `translate(${toX(x).toFixed(1)} ${toY(y).toFixed(1)})`);
  } };
}

// Lines and marks with a label, in as many rows as they need.
function legendOf(spec, width) {
  const group = svgElement("g", { class: "legend" }), lines = spec.lines.filter(line => line.label);
  if (!spec.legend && lines.length < 2) return { group, rows: 0 };
  const marks = (spec.marks ?? []).filter((mark, i, all) => mark.label && all.findIndex(one => one.label === mark.label) === i);
  let x = 0, row = 0;
  for (const one of [...lines, ...marks]) {
    const sign = one.shape ? 14 : 26, wide = sign + 6.1 * one.label.length + 14;
    if (x > 0 && x + wide > width) { x = 0; row++; }
    const y = 17 * row, place = `translate(${x} ${y})`;
    group.append(one.shape
      ? svgElement("g", { class: `mark ${one.kind}`, transform: `translate(${x + 5} ${y - 4})` }, svgElement("path", { d: MARKS[one.shape], class: one.filled ? "filled" : "open" }))
      : svgElement("path", { class: `line ${one.kind}`, transform: place, d: "M0 -4h20" }),
    svgElement("text", { x: x + sign, y }, one.label));
    x += wide;
  }
  return { group, rows: group.childNodes.length ? row + 1 : 0 };
}

// The values of the point of a line that is nearest to the pointer.
function probeOf(svg, spec, { toX, toY, left, right, top }) {
  const dot = svgElement("path", { d: MARKS.circle }), text = svgElement("text", {}), probe = svgElement("g", { class: "probe", visibility: "hidden" }, dot, text);
  const [xUnit, yUnit] = [spec.xLabel, spec.yLabel].map(label => label.match(/\((.*)\)/)?.[1] ?? "");
  const told = (value, unit) => `${shown(value)}${unit && " "}${unit}`;
  svg.addEventListener("pointerleave", () => probe.setAttribute("visibility", "hidden"));
  svg.addEventListener("pointermove", event => {
    const box = svg.getBoundingClientRect(), zoom = svg.width.baseVal.value / box.width;
    const at = [(event.clientX - box.left) * zoom, (event.clientY - box.top) * zoom];
    let best = { far: 40 };
    for (const line of spec.lines) for (let i = 1; i < line.x.length; i++) {
      if ([line.x[i - 1], line.y[i - 1], line.x[i], line.y[i]].includes(null)) continue;
      const [ax, ay, bx, by] = [toX(line.x[i - 1]), toY(line.y[i - 1]), toX(line.x[i]), toY(line.y[i])];
      const length = (bx - ax) ** 2 + (by - ay) ** 2, part = length ? Math.max(0, Math.min(1, ((at[0] - ax) * (bx - ax) + (at[1] - ay) * (by - ay)) / length)) : 0;
      const place = [ax + part * (bx - ax), ay + part * (by - ay)], far = Math.hypot(at[0] - place[0], at[1] - place[1]);
      if (far < best.far) best = { far, place, line, value: [line.x[i - 1] + part * (line.x[i] - line.x[i - 1]), line.y[i - 1] + part * (line.y[i] - line.y[i - 1])] };
    }
    probe.setAttribute("visibility", best.line ? "visible" : "hidden");
    if (!best.line) return;
    const [x, y] = best.place, before = x > (left + right) / 2;
    dot.setAttribute("transform", `translate(${x.toFixed(1)} ${y.toFixed(1)})`);
    text.setAttribute("x", x + (before ? -9 : 9));
    text.setAttribute("y", Math.max(top + 14, y - 8));
    text.setAttribute("text-anchor", before ? "end" : "start");
    text.textContent = `${told(best.value[0], xUnit)}, ${told(best.value[1], yUnit)}`;
  });
  return probe;
}

// What a figure shows, as rows of a table.
const SPECS = new WeakMap();

export function rowsOfChart(svg) {
  const { lines, bands = [], marks = [], xLabel, yLabel } = SPECS.get(svg), rows = [["series", xLabel, yLabel]];
  for (const { label, kind, x, y } of lines) x.forEach((value, i) => rows.push([label || kind, value, y[i]]));
  for (const { kind, x, lower, upper } of bands) for (const [name, y] of [["lower", lower], ["upper", upper]]) x.forEach((value, i) => rows.push([`band ${kind} ${name}`, value, y[i]]));
  for (const { title, label, x, y } of marks) rows.push([title || label, x, y]);
  return rows;
}

function turns(x) {
  const found = [];
  let from = 0;
  for (let i = 1; i < x.length - 1; i++) if ((x[i] - x[i - 1]) * (x[i + 1] - x[i]) < 0) { found.push([from, i]); from = i; }
  if (x.length > 1) found.push([from, x.length - 1]);
  return found;
}

// A figure as a file of its own: the look that the page gives it is written into it.
const LOOK = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "opacity", "fill-opacity", "font-family", "font-size", "font-style", "visibility"];

export function standalone(svg) {
  const copy = svg.cloneNode(true);
  const from = [svg, ...svg.querySelectorAll("*")], to = [copy, ...copy.querySelectorAll("*")];
  from.forEach((one, i) => {
    const look = getComputedStyle(one);
    for (const name of LOOK) to[i].setAttribute(name, look.getPropertyValue(name));
    to[i].removeAttribute("class");
    to[i].removeAttribute("tabindex");
  });
  copy.querySelector(".probe")?.remove();
  copy.querySelectorAll(".handle").forEach(handle => handle.remove());
  const size = svg.getBoundingClientRect();
  copy.setAttribute("width", Math.round(size.width));
  copy.setAttribute("height", Math.round(size.height));
  copy.setAttribute("xmlns", NS);
  const paper = getComputedStyle(document.body).backgroundColor;
  copy.prepend(svgElement("rect", { width: "100%", height: "100%", fill: paper }));
  return new XMLSerializer().serializeToString(copy);
}

export async function asPng(svg, scale = 3) {
  const image = new Image();
  const url = URL.createObjectURL(new Blob([standalone(svg)], { type: "image/svg+xml" }));
  try {
    await new Promise((done, failed) => { image.onload = done; image.onerror = failed; image.src = url; });
    const canvas = document.createElement("canvas");
    canvas.width = scale * image.width;
    canvas.height = scale * image.height;
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise(done => canvas.toBlob(done, "image/png"));
  } finally {
    URL.revokeObjectURL(url);
  }
}
