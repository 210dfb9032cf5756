// The section and the column, drawn to scale, with handles that are dragged or moved by keys.

import { svgElement } from "./chart.js";
import { barSize, shown, stepOf, unitOf } from "./units.js";

const valueIn = (drawing, path) => path.split(".").reduce((part, name) => part?.[name], drawing);
const SECTION = 190, LEFT = 26, TOP = 16, HEIGHT = 250, ALONE = 214;

// The handles of a section: where each is, which field it moves, how a pixel moves it, steps of the keys.
function handlesOf({ section, layout }, look) {
  const round = section.shape.includes("circle");
  const { scale, cx, cy } = look, half = size => 0.5 * size * scale;
  const found = [];
  if (round) {
    found.push({ path: "section.diameter", label: "Diameter", x: cx + half(section.diameter), y: cy, way: [2 / scale, 0], grid: 0.01, cursor: "ew-resize", text: section.diameter });
  } else {
    found.push({ path: "section.width", label: "Width", x: cx + half(section.width), y: cy, way: [2 / scale, 0], grid: 0.01, cursor: "ew-resize" });
    found.push({ path: "section.depth", label: "Depth", x: cx, y: cy + half(section.depth), way: [0, 2 / scale], grid: 0.01, cursor: "ns-resize" });
  }
  const depth = round ? section.diameter : section.depth;
  found.push({ path: "section.cover", label: "Cover", x: cx - (round ? 0 : 0.25 * section.width * scale), y: cy - half(depth) + section.cover * scale, way: [0, 1 / scale], grid: 0.001, cursor: "ns-resize", least: 0 });
  if ("wall" in section && section.shape.startsWith("hollow"))
    found.push({ path: "section.wall", label: "Wall", x: cx - half(round ? section.diameter : section.width) + section.wall * scale, y: cy, way: [1 / scale, 0], grid: 0.01, cursor: "ew-resize" });
  if (look.bar && typeof layout?.diameter === "number") found.push({ path: "layout.diameter", label: "Bar diameter", x: look.bar[0] + 0.5 * layout.diameter * scale, y: look.bar[1], way: [2 / scale, 0], bar: true, cursor: "ew-resize" });
  return found;
}

const sizesOf = ({ section }) => [section.cover, ...(section.shape.includes("circle") ? [section.diameter] : [section.width, section.depth])];

function refused(host, svg) {
  svg.append(svgElement("text", { x: 20, y: 40 }, "Nothing is drawn: a size is empty or no number."));
  host.replaceChildren(svg);
}

// A section to scale with its sizes; returns what its handles need.
function sectionInto(svg, { section }, figure, scale, system) {
  const cx = LEFT + SECTION / 2 - 6, cy = TOP + SECTION / 2, X = x => cx + x * scale, Y = y => cy - y * scale;
  const line = points => points.map(([x, y], i) => (i ? "L" : "M") + X(x).toFixed(1) + " " + Y(y).toFixed(1)).join("") + "Z";
  const round = section.shape.includes("circle");
  const wide = round ? section.diameter : section.width, deep = round ? section.diameter : section.depth;
  svg.append(round
    ? svgElement("circle", { class: "concrete", cx, cy, r: Math.max(0, 0.5 * wide * scale) })
    : ["tee", "wall"].includes(section.shape) && figure ? svgElement("path", { class: "concrete", d: line(figure.outline) })
    : svgElement("rect", { class: "concrete", x: X(-wide / 2), y: Y(deep / 2), width: Math.max(0, wide * scale), height: Math.max(0, deep * scale) }));
  let bar = null;
  if (figure) {
    if (figure.hoops.length) svg.append(svgElement("path", { class: "hoop", "fill-rule": "evenodd", d: figure.hoops.map(line).join("") }));
    for (const leg of figure.legs) svg.append(svgElement("path", { class: "hoop", d: line(leg) }));
    if (figure.void.length) svg.append(svgElement("path", { class: "void", d: line(figure.void) }));
    for (const [x, y, d] of figure.bars) {
      svg.append(svgElement("circle", { class: "bar", cx: X(x).toFixed(1), cy: Y(y).toFixed(1), r: (0.5 * d * scale).toFixed(2) }));
      if (!bar || x - y > bar[2]) bar = [X(x), Y(y), x - y];
    }
  }
  const [unit, factor] = unitOf(system, "length");
  svg.append(svgElement("text", { class: "size", x: cx, y: Y(-deep / 2) + 24, "text-anchor": "middle" }, (round ? "⌀ " : "") + shown(wide / factor) + " " + unit));
  if (!round) svg.append(svgElement("text", { class: "size", "text-anchor": "middle", transform: `translate(${(X(-wide / 2) - 9).toFixed(1)} ${cy}) rotate(-90)` }, shown(deep / factor) + " " + unit));
  return { scale, cx, cy, bar };
}

const scaleOf = ({ section }) => 150 / Math.max(...(section.shape.includes("circle") ? [positive(section.diameter, 0.4)] : [positive(section.flange_width ?? section.width, 0.4), positive(section.depth, 0.4)]));

// A section alone, with its handles; a scale that is given stays while a handle moves. Returns the scale.
export function drawSection(host, drawing, figure, { system, scale = scaleOf(drawing), title, kind, move, moved, stale }) {
  const svg = svgElement("svg", { viewBox: `0 0 ${LEFT + SECTION + 14} ${ALONE}`, class: `drawing ${kind}` + (stale ? " stale" : ""), role: "group", "aria-label": `Section of the ${title}` });
  if (sizesOf(drawing).some(value => typeof value !== "number")) { refused(host, svg); return scale; }
  const look = sectionInto(svg, drawing, figure, scale, system);
  svg.append(svgElement("text", { class: "name", x: 4, y: 14 }, title));
  host.replaceChildren(svg);
  for (const handle of handlesOf(drawing, look)) svg.append(handleElement(svg, handle, drawing, { system, move, moved }));
  return scale;
}

// Scales of a drawing; kept while a handle moves, so that the drawing does not run away.
export function scalesOf(column) {
  const { section, column: frame, concrete } = column;
  const round = section.shape.includes("circle"), wide = positive(round ? section.diameter : section.width, 0.4), deep = positive(round ? section.diameter : section.depth, 0.4);
  const height = positive(frame.height, 1.6) + footingHeight(column);
  const squash = wide * deep * positive(concrete.fc, 30e6);
  return { section: scaleOf(column), tall: 118 / height, force: 75 / (0.5 * squash), grid: 10 ** Math.floor(Math.log10(squash / 100)) };
}

function positive(value, otherwise) {
  return typeof value === "number" && value > 0 ? value : otherwise;
}

function footingHeight({ footed, column }) {
  return footed ? positive(column.footing_height, 0) : 0;
}

// host gets one svg; `move(path, value, done)` is called while a handle moves.
export function drawColumn(host, column, figure, { system, scales, kind, title, move, moved, fixed, stale }) {
  const { section, column: frame } = column;
  const svg = svgElement("svg", { viewBox: `0 0 ${LEFT + SECTION + 170} ${HEIGHT}`, class: `drawing ${kind}` + (stale ? " stale" : ""), role: "group", "aria-label": `Drawing of column ${title}` });
  if ([frame.height, frame.axial_load, ...sizesOf(column)].some(value => typeof value !== "number")) { refused(host, svg); return; }
  const look = sectionInto(svg, column, figure, scales.section, system), deep = section.shape.includes("circle") ? section.diameter : section.depth;
  const [unit, factor] = unitOf(system, "length");
  const measure = (x, y, value, anchor = "middle") => svg.append(svgElement("text", { class: "size", x, y, "text-anchor": anchor }, value));
  // The column from the side: as wide as the section is deep, at its own scale.
  const double = frame.top === "fixed", px = LEFT + SECTION + 78, ground = HEIGHT - 28, tall = scales.tall;
  const springs = column.footed, foot = ground - footingHeight(column) * tall;
  const ptop = foot - frame.height * tall, thick = Math.max(6, Math.min(60, deep * tall)), stub = 11;
  const hatch = y => { let d = ""; for (let i = 0; i < 9; i++) d += `M${px - 40 + i * 10} ${y}l-7 7`; return d; };
  svg.append(svgElement("rect", { class: "concrete", x: px - thick / 2, y: ptop, width: thick, height: Math.max(0, foot - ptop) }));
  // How it bends.
  const bent = px + 0.3 * thick + 8, quarter = (foot - ptop) / 3;
  svg.append(svgElement("path", { class: "thin bent", d: `M${px} ${foot}C${px} ${foot - quarter} ${double ? bent : (px + 2 * bent) / 3} ${ptop + quarter} ${bent} ${ptop}` }));
  if (springs) {
    svg.append(svgElement("rect", { class: "concrete", x: px - 34, y: foot, width: 68, height: ground - foot }));
    const zigzag = "l3 1.5l-6 2l6 2l-6 2l6 2l-3 1.5";
    svg.append(svgElement("path", { class: "spring", d: `M${px - 26} ${ground}${zigzag}M${px + 26} ${ground}${zigzag}M${px + 34} ${(foot + ground) / 2}h4l1.5 -3l2 6l2 -6l2 6l2 -6l1.5 3h3m0 -7v14M${px - 42} ${ground + stub}h84` }));
  } else svg.append(svgElement("rect", { class: "concrete", x: px - 42, y: ground, width: 84, height: stub }));
  svg.append(svgElement("path", { class: "thin", d: hatch(ground + stub) }));
  if (double) svg.append(svgElement("rect", { class: "concrete", x: px - 42, y: ptop - stub, width: 84, height: stub }));
  const above = double ? ptop - stub : ptop;
  const [load, N] = [frame.axial_load, unitOf(system, "force")];
  const length = Math.max(-70, Math.min(70, load * scales.force)), tail = above - 4 - Math.max(8, Math.abs(length));
  const tip = length >= 0 ? above - 3 : tail, start = length >= 0 ? tail : above - 3;
  svg.append(svgElement("path", { class: "arrow", d: `M${px} ${start}V${tip}m-4 ${length >= 0 ? -7 : 7}l4 ${length >= 0 ? 7 : -7}l4 ${length >= 0 ? -7 : 7}` }));
  svg.append(svgElement("path", { class: "arrow lateral", d: `M${px - thick / 2 - 40} ${ptop + 4}H${px - thick / 2 - 3}m-7 -4l7 4l-7 4` }));
  measure(px + 10, tail + 6, `${shown(load / N[1])} ${N[0]}`, "start");
  measure(px + thick / 2 + 8, (ptop + foot) / 2 + 4, `${shown(frame.height / factor)} ${unit}`, "start");
  svg.append(svgElement("text", { class: "name", x: 4, y: 14 }, title));
  host.replaceChildren(svg);
  if (fixed) return;
  const handles = [...handlesOf(column, look),
    { path: "column.height", label: "Height", x: px, y: ptop, way: [0, -1 / tall], grid: 0.05, cursor: "ns-resize" },
    { path: "column.axial_load", label: "Axial load", x: px, y: tail, way: [0, -1 / scales.force], grid: scales.grid, cursor: "ns-resize", dimension: "force", least: -Infinity }];
  for (const handle of handles) svg.append(handleElement(svg, handle, column, { system, move, moved }));
}

function handleElement(svg, handle, column, { system, move, moved }) {
  const value = valueIn(column, handle.path), dimension = handle.dimension ?? "length";
  const [unit, factor] = unitOf(system, dimension);
  const grid = handle.bar ? 0 : stepOf(system, dimension, handle.grid), least = handle.least ?? grid;
  const g = svgElement("g", { class: "handle", tabindex: 0, role: "slider", "aria-label": handle.label, "data-path": handle.path,
    "aria-valuemin": Number.isFinite(least) ? shown(least / factor).replace("−", "-") : "-1e9", "aria-valuemax": "1e9", "aria-valuenow": Number((value / factor).toPrecision(6)),
    "aria-valuetext": `${shown(value / factor)} ${unit}`, transform: `translate(${handle.x.toFixed(1)} ${handle.y.toFixed(1)})` },
    svgElement("circle", { class: "reach", r: 13 }), svgElement("circle", { class: "knob", r: 4.5 }));
  g.style.cursor = handle.cursor;
  const put = (wanted, done) => move(handle.path, handle.bar ? barSize(system, wanted) : Math.max(least, Number((Math.round(wanted / grid) * grid).toPrecision(10))), done);
  g.addEventListener("pointerdown", event => {
    if (event.button) return;
    event.preventDefault();
    const box = svg.getBoundingClientRect(), zoom = svg.viewBox.baseVal.width / box.width;
    const from = [event.clientX, event.clientY], before = valueIn(column, handle.path);
    let last = before;
    const drag = now => {
      last = before + zoom * ((now.clientX - from[0]) * handle.way[0] + (now.clientY - from[1]) * handle.way[1]);
      put(last, false);
    };
    const end = () => {
      window.removeEventListener("pointermove", drag);
      window.removeEventListener("pointerup", end);
      window.removeEventListener("pointercancel", end);
      put(last, true);
      moved(handle.path);
    };
    window.addEventListener("pointermove", drag);
    window.addEventListener("pointerup", end);
    window.addEventListener("pointercancel", end);
    moved(handle.path, true);
  });
  g.addEventListener("keydown", event => {
    const way = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 5, PageDown: -5 }[event.key];
    if (!way) return;
    event.preventDefault();
    const now = valueIn(column, handle.path);
    put(handle.bar ? barSize(system, now, way) : now + way * grid, true);
  });
  return g;
}
