// The view of a frame: storeys and bays of drawn members, pushed, moved to and fro, or shaken.

import { inUnits, shown, unitOf } from "./units.js";
import { drawChart, svgElement } from "./chart.js";
import { drawSection } from "./drawing.js";
import { COLUMN_FIELDS, LOADINGS, LOADING_FIELDS, element, fieldGroup, fieldRow, loadingRows, putAt, refreshFields, showFaults, toldAs, valueAt } from "./fields.js";
import { table, timeChart } from "./panels.js";
import { beside, changed, copied, edit, get, keyOf, page, say, showNotes, showStatus } from "./machine.js";

const lengths = { dimension: "length", list: true }, count = { dimension: "number", whole: true, step: 1 };
const GRID = [
  { path: "frame.storeys", label: "Heights of the storeys, from the ground", ...lengths },
  { path: "frame.bays", label: "Widths of the bays", ...lengths },
];
const MATERIALS = [
  { path: "frame.concrete.fc", label: "Concrete strength", dimension: "stress", step: 1e6 },
  { path: "frame.bars.fy", label: "Yield stress of bars", dimension: "stress", step: 1e7 },
  { path: "frame.ties.fy", label: "Yield stress of hoops", dimension: "stress", step: 1e7 },
];
const SHARED = ["concrete.fc", "bars.fy", "bars.fu", "ties.fy", "ties.fu"];
const DRAWN = COLUMN_FIELDS.slice(0, 3).flatMap(({ fields }) => fields).filter(({ path }) => !SHARED.includes(path))
  .map(field => ({ ...field, label: (({ bars: "Bars: ", ties: "Ties: " })[field.path.split(".")[0]] ?? "") + field.label }));
const named = what => field => ({ ...field, path: `${what}.${field.path}` });
const row = (side, label) => [{ path: `${side}.number`, label: `Bars ${label}`, ...count }, { path: `${side}.diameter`, label: `Their diameter`, dimension: "length", bar: true }];
const COLUMN = DRAWN.map(named("column"));
const BEAM = [...DRAWN.filter(({ path }) => ["section.width", "section.depth", "section.cover"].includes(path)),
  { path: "section.slab", label: "Thickness of the slab", dimension: "length", step: 0.01, optional: "no slab" },
  { path: "section.flange", label: "Effective width of the slab", dimension: "length", step: 0.05, slab: true },
  ...row("top", "above"), ...row("bottom", "below"), ...DRAWN.filter(({ path }) => ["ties.diameter", "ties.spacing", "ties.legs"].includes(path))].map(named("beam")).map(({ shapes, ...field }) => field);
const LOADS = [
  { path: "frame.dead_load", label: "Dead load on the beams", dimension: "line", step: 1e3 },
  { path: "frame.live_load", label: "Live load on the beams", dimension: "line", step: 1e3 },
  { path: "frame.live_share", label: "Share of the live load that acts", dimension: "share", step: 0.05 },
  { path: "frame.self_weight", label: "Weight of the members", choices: [[true, "25 kN/m³"], [false, "in the dead load"]] },
  { path: "frame.kinematics", label: "P-Delta", choices: [["pdelta", "on"], ["small", "off"]] },
  { path: "frame.damping", label: "Damping of all modes", dimension: "share", step: 0.01 },
];
const DEMAND = [
  { path: "frame.demand.code", label: "Code", choices: [["en_1998_3", "EN 1998"], ["asce_41", "ASCE 41-17"]] },
  { path: "frame.demand.ag", label: "Acceleration on rock, in g", dimension: "ratio", step: 0.05, code: "en_1998_3" },
  { path: "frame.demand.soil", label: "Ground", choices: ["A", "B", "C", "D", "E"].map(soil => [soil, soil]), code: "en_1998_3" },
  { path: "frame.demand.s_xs", label: "S_XS, in g", dimension: "ratio", step: 0.05, code: "asce_41" },
  { path: "frame.demand.s_x1", label: "S_X1, in g", dimension: "ratio", step: 0.05, code: "asce_41" },
];
const [KIND, ...REST] = LOADING_FIELDS;
const LOADING = [{ ...KIND, choices: [["push", "push to one side"], ...KIND.choices] }, { path: "loading.drift", label: "Roof drift of the push", dimension: "drift", step: 0.005, kinds: ["push"] }, ...REST];
const FIELDS = Object.fromEntries([GRID, MATERIALS, COLUMN, BEAM, LOADS, DEMAND, LOADING].flat().map(field => [field.path, field]));
// Hinges by the furthest that they have reached, and ends by the levels of the code that they have passed.
const STATES = [["cracking", "cracked", "cracked"], ["yield", "yielded", "yielded"], ["cap", "beyond", "failed or beyond their cap"], ["shear_failure", "beyond"], ["lost", "beyond"]];
const PASSED = ["within", "yielded", "far", "beyond"];

// The storey whose members are shown, or 0 for all; the member that was chosen; whether levels are shown.
let storey = 0, chosen = "", byLevels = false, timer = null, scales = {}, timeFigure = null;

const answer = () => frameView.stood.loops?.frame;
const checks = () => beside("checks", frameView);

export const frameView = {
  name: "frame", label: "frames", scrubs: "building",
  titles: { draw: "Sections", loops: "Base shear and roof drift", states: "Limit states of members", timepanel: "Storey drifts in time" },
  panels: { loops: ["building", "loops", "summary", "storeys", "states", "history"], checks: ["members"] },
  accepts: found => Boolean(found.frame.displacement),
  isState: ({ frame }) => frame && Array.isArray(frame.bays) && Array.isArray(frame.storeys) && frame.storeys.length > 0 && frame.storeys.every(one => one && typeof one === "object"),
  tidied: ({ frame, loading }) => ({ frame: { ...frame, removed: Array.isArray(frame.removed) ? frame.removed.map(String) : [] }, loading }),
  settle() { if (storey > frameView.state.frame.storeys.length) storey = 0; },
  begin() { frameView.settle(); },
  put, complete, showDrawings, showForm, showMessages, showPoint: () => { byLevels = false; showPoint(); },
  showLoops: showResponse, showStatus: showState,
  refresh() { refreshFields(get("form"), Object.values(FIELDS), valueOf, page.system); },
  resized: showResponse,
  showAll() { showForm(); showDrawings(); showResponse(); showMessages(); },
};

export const frameLanes = [{ lane: "checks", delay: 60, show: showChecks }];

// ---- the form --------------------------------------------------------------------------------------

const storeys = () => storey ? [frameView.state.frame.storeys[storey - 1]] : frameView.state.frame.storeys;
const isOfMember = path => /^(column|beam)\./.test(path);

// What a field shows: of a member that of the chosen storey, or of all where they are alike.
function valueOf(path) {
  if (path === "frame.storeys") return frameView.state.frame.storeys.map(one => one.height);
  if (!isOfMember(path)) return valueAt(frameView.state, path);
  const values = storeys().map(one => valueAt(one, path));
  return values.every(value => value === values[0]) ? values[0] : null;
}

function put(path, value) {
  const { frame } = frameView.state;
  if (path === "frame.storeys") {
    const last = frame.storeys.at(-1);
    // Without a height the members of a storey stay for the next one.
    frame.storeys = (value.length ? value : [null]).map((height, i) => ({ ...copied(frame.storeys[i] ?? last), height }));
    frameView.settle();
    showTabs();
  } else if (isOfMember(path)) for (const one of storeys()) putAt(one, path, value);
  else putAt(frameView.state, path, value);
}

function complete(path, done) {
  if (path === "loading.kind") {
    const { kind } = frameView.state.loading;
    frameView.state.loading = kind === "push" ? { kind, drift: 0.03 } : copied(LOADINGS[kind]);
    return true;
  }
  if (path === "column.section.shape") for (const { column: { section } } of storeys()) {
    const size = section.width ?? section.diameter ?? 0.4;
    if (section.shape.includes("circle")) section.diameter ??= size;
    else { section.width ??= size; section.depth ??= size; }
    if (section.shape.startsWith("hollow")) section.wall ??= Number((0.25 * size).toPrecision(3));
  }
  if (path === "beam.section.slab" && done) for (const { beam: { section } } of storeys()) section.flange ??= Number((3 * (section.width || 0.3)).toPrecision(3));
  return path === "frame.demand.code" || path === "column.section.shape" || (path === "beam.section.slab" && done);
}

function showTabs() {
  const host = get("tabs"), names = ["all storeys", ...frameView.state.frame.storeys.map((_, i) => `storey ${i + 1}`)];
  host.ariaLabel = "Storeys";
  host.replaceChildren(...names.map((name, i) => {
    const tab = element("button", { type: "button", className: "tab a", onclick: () => { choose(i); host.children[i].focus(); } }, name);
    tab.setAttribute("aria-pressed", String(i === storey));
    return tab;
  }));
}

function choose(level, member = "") {
  storey = level;
  chosen = member;
  showForm();
  showDrawings();
  showPoint();
}

function showForm() {
  const { frame, loading } = frameView.state, { system } = page;
  const rows = (fields, fits = () => true) => fields.filter(fits).map(field => {
    const differs = valueOf(field.path) === null && isOfMember(field.path) && !storey;
    return fieldRow(differs ? { ...field, optional: "differs" } : field, valueOf(field.path), system, (value, done) => edit(field.path, value, done), false);
  });
  const shape = valueOf("column.section.shape"), slab = storeys().some(one => one.beam?.section?.slab !== undefined);
  showTabs();
  get("form").replaceChildren(...[
    ["Grid", rows(GRID)],
    ["Columns", rows(COLUMN, field => !field.shapes || field.shapes.includes(shape))],
    ["Beams", rows(BEAM, field => !field.slab || slab)],
    ["Materials", rows(MATERIALS)],
    ["Loads", rows(LOADS)],
    ["Loading", loadingRows(loading, system, edit, false, LOADING)],
    ["Demand and acceptance", rows(DEMAND, field => !field.code || field.code === frame.demand?.code)],
  ].flatMap(([title, made]) => fieldGroup(title, made)));
  showMessages();
}

function showDrawings() {
  const host = get("drawings"), { state, latest } = frameView, at = Math.max(0, storey - 1), own = state.frame.storeys[at];
  get("draw").hidden = false;
  const focused = host.contains(document.activeElement) ? document.activeElement.dataset : null, column = focused && document.activeElement.closest("[data-column]")?.dataset.column;
  ["column", "beam"].forEach((what, i) => {
    if (!host.children[i]) host.append(element("div", { className: "drawbox" }));
    const box = host.children[i], figure = latest?.frame.sections[at]?.[i], drawing = { ...own[what], section: { shape: "beam", ...own[what]?.section } };
    box.dataset.column = what;
    scales[what] = drawSection(box, drawing, figure, { system: page.system, title: `${what}${storey ? ` of storey ${storey}` : ""}`, kind: "a", stale: latest?.key !== keyOf(state) || !figure, scale: page.dragging ? scales[what] : undefined,
      move: (path, value, done) => edit(`${what}.${path}`, value, done, true), moved: (path, begins = false) => { page.dragging = begins; if (!begins) showDrawings(); } });
  });
  while (host.children.length > 2) host.lastChild.remove();
  if (column) host.querySelector(`[data-column="${column}"] [data-path="${focused.path}"]`)?.focus();
}

// ---- what is shown ---------------------------------------------------------------------------------

function showState() {
  const found = answer();
  showStatus(found ? [`${found.members.length} members`, `${found.displacement.length} rows in ${Math.max(1, Math.round(1e3 * found.seconds))} ms`, found.stopped ? "ended early" : found.status] : []);
}

function showMessages() {
  const { latest } = frameView, { system } = page;
  const all = [...latest?.frame.faults ?? [], ...(latest?.frame.displacement ? checks()?.faults ?? [] : [])].map(fault => {
    const field = FIELDS[fault.field], value = field && valueOf(fault.field);
    return { field: fault.field, text: toldAs(fault, field, Array.isArray(value) ? value.filter(one => one !== null) : value, system) };
  });
  const notes = [latest?.frame.stopped, ...(latest?.frame.notes ?? [])].filter(Boolean).map(text => inUnits(text, system));
  showNotes(showFaults(get("form"), all), notes);
  say([...new Set(all.map(fault => fault.text))].join("; "));
}

function showResponse() {
  const found = answer();
  if (!found) { for (const id of ["frame", "loopfigure", "figures", "storeytable", "statetable", "membertable"]) get(id).replaceChildren(); return; }
  get("scrub").max = found.pictures.length - 1;
  get("history").hidden = !found.dynamic;
  get("scales").hidden = true;
  if (found.dynamic) timeFigure = timeChart(get("timefigure"), found.storey_drift[0].map((_, i) => ({ time: found.time, drift: found.storey_drift.map(one => one[i]), name: `storey ${i + 1}` })));
  showChecks();
  showState();
}

function showChecks() {
  const found = checks(), ends = (found?.ends ?? []).toSorted((a, b) => b.ratio - a.ratio);
  get("attarget").hidden = !found?.target?.reached;
  const told = found && `${found.levels?.at(-1) ?? ""} of ${found.code === "asce_41" ? "ASCE 41-17" : "EN 1998-3"}, ${found.at_target ? "at the target displacement" : "largest of all rows"}${(found.notes ?? []).map(one => `. ${one}`).join("")}`;
  get("membertable").replaceChildren(ends.length ? table(["Member", "end", "ratio", "levels passed", "by"], ends.slice(0, 12).map(one => ({ cells: [one.member, one.end, one.status === "evaluated" ? shown(one.ratio, 3) : "–", found.levels.slice(0, Math.max(0, one.passed)).join(", ") || "none", { text: one.status === "evaluated" ? one.governed_by : one.status }] })), told)
    : element("p", { className: "empty" }, found ? "No member is judged." : "Computing"));
  showMessages();
  showPoint();
}

function showPoint() {
  const found = answer();
  if (!found) return;
  const at = Math.min(Number(get("scrub").value), found.pictures.length - 1), row = found.pictures[at];
  const [unit, factor] = unitOf(page.system, "force"), drift = Math.round(1e5 * found.displacement[row] / found.height) / 1e3;
  const text = `${shown(drift, 3)} %, base shear ${shown(found.base_shear[row] / factor)} ${unit}` + (found.dynamic ? `, ${shown(found.time[row])} s` : "");
  get("scrubbed").textContent = text;
  get("scrub").setAttribute("aria-valuetext", text);
  drawFrame(get("frame"), found, at);
  drawCurve(get("loopfigure"), found, row);
  if (found.dynamic) timeFigure.moveCursor(found.time[row], 100 * found.storey_drift[row][0]);
  showTables(found, row);
  tell(chosen);
}

// Forces of a member in the row that is shown, and its demand over its capacity.
function tell(name) {
  const found = answer(), i = found?.members.indexOf(name) ?? -1, removed = frameView.state.frame.removed.includes(name);
  get("remove").disabled = !name;
  get("remove").textContent = removed ? `Put ${name} back` : name ? `Remove ${name}` : "Remove the member";
  if (i < 0) { get("told").textContent = removed ? `${name} is removed` : "A member under the pointer tells its forces; a click chooses it"; return; }
  const [force, newton] = unitOf(page.system, "force"), [moment, per] = unitOf(page.system, "moment"), at = Math.min(Number(get("scrub").value), found.pictures.length - 1);
  const [axial, first, last, shear] = found.forces[at][i], ratio = Math.max(-1, ...(checks()?.ends ?? []).filter(one => one.member === name && one.status === "evaluated").map(one => one.ratio));
  get("told").textContent = `${name}: N ${shown(axial / newton, 3)} ${force}, V ${shown(shear / newton, 3)} ${force}, M ${shown(first / per, 3)} and ${shown(last / per, 3)} ${moment}` + (ratio < 0 ? "" : `; demand over capacity ${shown(ratio, 3)}`);
}

// Hinges that were reached so far, or ends by the levels of the code: place and class.
function hingesOf(found, row) {
  const reached = new Map(), words = new Map();
  if (byLevels) for (const { member, end, passed } of checks()?.ends ?? []) reached.set(`${member} ${end}`, [member, end, PASSED[passed] ?? "unknown"]);
  else for (const { member, end, name, time, group } of found.events) {
    const kind = STATES.findIndex(([state]) => state === name), key = `${member} ${end}`;
    if (time > found.time[row] || kind < 0 || kind < (words.get(key) ?? 0)) continue;
    words.set(key, kind);
    reached.set(key, [member, group === "member" ? "0.5" : end, STATES[kind][1]]);
  }
  return reached.values();
}

// The frame with its dead load, and the frame on its way with its hinges.
function drawFrame(host, found, at) {
  const { storeys: levels, bays, removed } = frameView.stood.loops.state.frame, row = found.pictures[at];
  const wide = bays.reduce((sum, bay) => sum + bay, 0), high = found.height, width = Math.max(300, host.clientWidth);
  const [unit, factor] = unitOf(page.system, "length"), moved = found.moved[at];
  const ways = found.moved.flatMap(members => members.map(line => line.map(([x]) => x))).flat(), least = Math.min(0, ...bounded(ways, Math.min)), largest = Math.max(1e-12, ...bounded(ways, Math.max));
  // Room for the load at the left, for the displacements and the heights at the right.
  const times = Math.min(0.1 * Math.max(wide, high) / Math.max(largest, -least), 50), away = times * largest, before = -times * least;
  const scale = Math.min((width - 132) / (wide + away + before), 380 / high), left = 60 + before * scale + (width - 132 - (wide + away + before) * scale) / 2, top = 46, ground = top + high * scale;
  const legend = byLevels ? ["within all", ...(checks()?.levels ?? []).map(level => `beyond ${level}`)].map((text, i) => [PASSED[i], text]) : STATES.slice(0, 3).map(([, kind, text]) => [kind, text]);
  const narrow = width < 460, height = ground + 50 + 16 * (narrow ? legend.length : 1);
  const put = ([x, y]) => [left + x * scale, ground - y * scale], place = (i, point, far = times) => put([0, 1].map(k => found.still[i][point][k] + far * moved[i][point][k]));
  const path = (i, far) => found.still[i].map((_, point) => (point ? "L" : "M") + place(i, point, far).map(value => value.toFixed(1)).join(" ")).join("");
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, width, height, class: "chart frames", role: "group", "aria-label": `Frame of ${levels.length} storeys and ${bays.length} bays, displacements times ${shown(times, 2)}. Arrow keys go from member to member, Delete removes one.` });
  const focused = host.contains(document.activeElement) ? document.activeElement.dataset?.name : null;
  const axes = bays.reduce((all, bay) => [...all, all.at(-1) + bay], [0]), floors = levels.reduce((all, one) => [...all, all.at(-1) + one.height], [0]);
  const member = (name, d, words, kind = "") => {
    const line = svgElement("path", { class: `member${chosen === name || (storey && !chosen && levelOf(name) === storey) ? " chosen" : ""}${kind}`, d, role: "button", tabindex: name === (chosen || found.members[0]) ? 0 : -1, "data-name": name, "aria-label": words });
    line.addEventListener("pointerenter", () => tell(name));
    line.addEventListener("pointerleave", () => tell(chosen));
    line.addEventListener("focus", () => tell(name));
    line.addEventListener("click", () => pick(name));
    line.append(svgElement("title", {}, words));
    svg.append(line);
  };
  for (const name of removed) {
    const [what, i, k] = name.split("-"), ends = what === "C" ? [[axes[i - 1], floors[k - 1]], [axes[i - 1], floors[k]]] : [[axes[i - 1], floors[k]], [axes[i], floors[k]]];
    if (ends.flat().every(Number.isFinite)) member(name, ends.map((end, j) => (j ? "L" : "M") + put(end).join(" ")).join(""), `${name} is removed: choose it to put it back`, " removed");
  }
  found.members.forEach((name, i) => {
    svg.append(svgElement("path", { class: "zero", d: path(i, 0) }));
    member(name, path(i, times), `${name} of storey ${levelOf(name)}`);
    if (!name.startsWith("B")) return;
    const [[x0, y], [x1]] = [place(i, 0, 0), place(i, found.still[i].length - 1, 0)];
    let load = `M${x0} ${y - 14}H${x1}`;
    for (let k = 1; k < 7; k++) load += `M${x0 + k * (x1 - x0) / 7} ${y - 14}v10m-2 -4l2 4l2 -4`;
    svg.append(svgElement("path", { class: "thin", d: load }));
  });
  axes.forEach((x, i) => {
    svg.append(svgElement("path", { class: "thin", d: `M${left + x * scale} ${ground}m-11 0h22m-18 0l-4 5m9 -5l-4 5m9 -5l-4 5m9 -5l-4 5` }));
    if (i) svg.append(svgElement("text", { x: left + (x - bays[i - 1] / 2) * scale, y: ground + 19, "text-anchor": "middle" }, `${shown(bays[i - 1] / factor)} ${unit}`));
  });
  levels.forEach(({ height: own }, i) => {
    svg.append(svgElement("text", { x: left + (wide + away) * scale + 12, y: ground - (floors[i] + own / 2) * scale }, `${shown(own / factor)} ${unit}`));
    const force = 12 + 34 * floors[i + 1] / high;
    if (at && !found.dynamic) svg.append(svgElement("path", { class: "arrow", d: `M${left - before * scale - 10 - force} ${ground - floors[i + 1] * scale}h${force}m-6 -3.5l6 3.5l-6 3.5` }));
  });
  for (const [name, end, kind] of hingesOf(found, row)) {
    const i = found.members.indexOf(name);
    if (i < 0) continue;
    const last = found.still[i].length - 1, share = { start: 0.08, end: 0.92 }[end] ?? (Number(end) || 0.5), point = Math.min(last - 1, Math.floor(share * last)), part = share * last - point;
    const [a, b] = [place(i, point), place(i, point + 1)];
    svg.append(svgElement("circle", { class: `hinge ${kind}`, cx: (a[0] + part * (b[0] - a[0])).toFixed(1), cy: (a[1] + part * (b[1] - a[1])).toFixed(1), r: 4.2 }));
  }
  legend.forEach(([kind, words], i) => {
    const [x, y] = narrow ? [8, ground + 38 + 16 * i] : [8 + 140 * i, ground + 38];
    svg.append(svgElement("circle", { class: `hinge ${kind}`, cx: x + 4, cy: y, r: 4.2 }), svgElement("text", { x: x + 13, y: y + 4 }, words));
  });
  svg.append(svgElement("text", { x: 4, y: height - 5 }, `Displacements × ${shown(times, 2)}${byLevels ? "; ends by the levels that they have passed" : ""}`));
  svg.addEventListener("keydown", event => keyed(event, found.members.concat(removed)));
  host.replaceChildren(svg);
  if (focused) svg.querySelector(`[data-name="${focused}"]`)?.focus();
}

const levelOf = name => Number(name.split("-")[2]);

// Least or largest of many numbers, for which a call has no room.
function bounded(values, of) {
  return [values.reduce((best, value) => of(best, value), 0)];
}

function pick(name) {
  choose(chosen === name ? 0 : levelOf(name), chosen === name ? "" : name);
}

function keyed(event, names) {
  const name = event.target.dataset?.name, way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
  if (!name) return;
  if (way) { chosen = names[(names.indexOf(name) + way + names.length) % names.length]; showPoint(); }
  else if (event.key === "Enter" || event.key === " ") pick(name);
  else if (event.key === "Delete") remove(name);
  else return;
  event.preventDefault();
}

function remove(name) {
  const { frame } = frameView.state;
  frame.removed = frame.removed.includes(name) ? frame.removed.filter(one => one !== name) : [...frame.removed, name];
  chosen = name;
  changed(true);
}

function drawCurve(host, found, row) {
  const [unit, factor] = unitOf(page.system, "force"), [length, metre] = unitOf(page.system, "length"), point = checks()?.target;
  const drifts = values => values.map(value => 100 * value / found.height), drift = drifts(found.displacement), shear = found.base_shear.map(value => value / factor);
  const marks = found.dynamic ? [] : found.events.filter(event => event.name !== "cracking" && event.time <= found.time[row]).map(event => ({ x: 100 * event.drift, y: event.force / factor, shape: "circle", kind: "a", label: "yield or failure of a section", title: `${event.member}, ${event.end}: ${event.name}` }));
  const lines = [{ x: drift, y: shear, kind: "test thin", label: "the whole way" }, { x: drift.slice(0, row + 1), y: shear.slice(0, row + 1), kind: "a", label: "so far" }];
  if (point?.reached) {
    lines.push({ x: drifts(point.lines[0].map(value => value + found.displacement[0])), y: point.lines[1].map(value => value / factor), kind: "b thin dashed", label: "two lines of the code" });
    marks.push({ x: 100 * point.signed / found.height, y: point.base_shear / factor, shape: "diamond", filled: true, kind: "b", label: "target displacement", title: `target displacement, ${point.spectrum}` });
  }
  drawChart(host, { lines, marks, ...(found.dynamic || Math.min(...drift) < -0.05 ? { symmetric: true, zero: true } : { fromZero: true }), legend: true, height: 330,
    xLabel: "Roof drift (%)", yLabel: `Base shear (${unit})`, top: { factor: found.height / 100 / metre, label: `roof displacement (${length})` }, label: `Base shear against roof drift; largest ${shown(found.peak.base_shear / factor)} ${unit}` });
}

function showTables(found, row) {
  const [unit, factor] = unitOf(page.system, "force"), [length, metre] = unitOf(page.system, "length"), point = checks()?.target, { peak } = found;
  const percent = value => `${shown(100 * value, 3)} %`, first = found.events.find(event => event.name === "yield");
  const facts = [["first period", found.period === null ? "–" : `${shown(found.period, 3)} s`], ["dead load", `${shown(found.weight / factor)} ${unit}`], ["largest base shear", `${shown(peak.base_shear / factor)} ${unit}`],
    ["the same over the dead load", found.weight ? shown(peak.base_shear / found.weight, 3) : "–"], ["largest roof drift", percent(peak.drift)], ["roof drift at the first yield", first ? (first.dead ? "under the dead load" : percent(Math.abs(first.drift))) : "–"]];
  if (found.dynamic) facts.push(["residual storey drift", percent(peak.residual)]);
  if (point) facts.push(["target displacement", `${shown(point.displacement / metre)} ${length} = ${percent(point.displacement / found.height)}`], ...(point.reached ? [["base shear there", `${shown(point.base_shear / factor)} ${unit}`], ["ductility there", shown(point.ductility, 3)]] : [["", "the push ends before it"]]));
  get("figures").replaceChildren(table(["", ""], facts.map(cells => ({ cells })), point?.spectrum ?? ""));
  const there = point?.storey_drift, drift = found.storey_drift[row], shear = found.storey_shear[row];
  get("storeytable").replaceChildren(table(["Storey", "drift %", `shear ${unit}`, "largest %", `largest ${unit}`, ...(there ? ["at target %"] : [])], drift.map((value, i) =>
    ({ cells: [String(i + 1), shown(100 * value, 3), shown(shear[i] / factor), shown(100 * peak.storey_drift[i], 3), shown(peak.storey_shear[i] / factor), ...(there ? [shown(100 * there[i], 3)] : [])] })).reverse(), `At a roof drift of ${percent(found.displacement[row] / found.height)}`));
  const events = found.events.filter(event => event.name !== "cracking");
  get("statetable").replaceChildren(events.length ? table(["Member", "section", "state", ...(found.dynamic ? ["time s"] : []), "roof drift %", `base shear ${unit}`], events.slice(0, 60).map(event => ({ kind: event.time <= found.time[row] ? "" : "later",
    cells: [event.member, ["start", "end", ""].includes(event.end) ? event.end : shown(Number(event.end), 2), event.name, ...(found.dynamic ? [shown(event.time, 4)] : []), ...(event.dead ? ["dead load", "–"] : [shown(100 * event.drift, 3), shown(event.force / factor)])] })), events.length > 60 ? `${events.length - 60} more in the report` : "") : element("p", { className: "empty" }, "No section yields."));
}

// ---- what is done ----------------------------------------------------------------------------------

function play() {
  const scrub = get("scrub");
  if (timer) { clearInterval(timer); timer = null; get("play").textContent = "Play"; return; }
  if (scrub.value === scrub.max) scrub.value = 0;
  get("play").textContent = "Stop";
  byLevels = false;
  timer = setInterval(() => {
    if (page.view !== frameView) { play(); return; }
    scrub.value = Number(scrub.value) + 1;
    showPoint();
    if (scrub.value === scrub.max) play();
  }, 90);
}

// The picture nearest to the target displacement, with the levels that each end has passed there.
function goToTarget() {
  const found = answer(), { signed } = checks().target, away = found.pictures.map(row => Math.abs(found.displacement[row] - signed));
  get("scrub").value = away.indexOf(Math.min(...away));
  byLevels = true;
  showPoint();
}

get("play").addEventListener("click", play);
get("attarget").addEventListener("click", goToTarget);
get("remove").addEventListener("click", () => remove(chosen));
