// The page of frames: storeys and bays, dead load, a push to one side.

import { SYSTEMS, inUnits, shown, unitOf } from "./units.js";
import { drawChart, svgElement } from "./chart.js";
import { element, fieldRow, showFaults, toldAs, valueAt, putAt } from "./fields.js";
import { addSaves, download, saveShown, table } from "./panels.js";
import { packed, unpackedFrame } from "./history.js";
import { makeLane } from "./answers.js";

const get = id => document.getElementById(id);
const lengths = { dimension: "length", list: true };
const GRID = [
  { path: "frame.storeys", label: "Heights of the storeys, from the ground", ...lengths },
  { path: "frame.bays", label: "Widths of the bays", ...lengths },
];
const MEMBERS = ["column", "beam"].map(what => [what, [
  { path: `${what}.width`, label: "Width", dimension: "length", step: 0.05 },
  { path: `${what}.depth`, label: "Depth", dimension: "length", step: 0.05 },
  { path: `${what}.moment`, label: "Yield moment", dimension: "moment", step: 1e4 },
]]);
const ALL = [
  { path: "frame.modulus", label: "Young's modulus", dimension: "stress", step: 1e9 },
  { path: "frame.column_share", label: "Columns: inertia of the gross section", dimension: "share", step: 0.05 },
  { path: "frame.beam_share", label: "Beams: inertia of the gross section", dimension: "share", step: 0.05 },
  { path: "frame.hardening", label: "Stiffness after yield", dimension: "share", step: 0.005 },
];
const LOADS = [
  { path: "frame.beam_load", label: "Dead load on the beams", dimension: "line", step: 1e3 },
  { path: "frame.drift", label: "Roof drift of the push", dimension: "drift", step: 0.005 },
];
const FIELDS = Object.fromEntries([...GRID, ...MEMBERS.flatMap(([, fields]) => fields), ...ALL, ...LOADS].map(field => [field.path, field]));
// Colours of hinges by their largest rotation over that at yield.
const HINGES = [[1, "yielded", "to twice its rotation at yield"], [2, "far", "to five times"], [5, "beyond", "beyond five times"]];

let frame = null, system = "mm", storey = 0, answer = null, asked = null, timer = null;

// ---- the form --------------------------------------------------------------------------------------

// What a field shows: of a member that of the chosen storey, or of all where they are alike.
function valueOf(path) {
  if (path === "frame.storeys") return frame.storeys.map(one => one.height);
  if (path.startsWith("frame.")) return valueAt({ frame }, path);
  const values = (storey ? [frame.storeys[storey - 1]] : frame.storeys).map(one => valueAt(one, path));
  return values.every(value => value === values[0]) ? values[0] : null;
}

function edit(path, value) {
  if (path === "frame.storeys") {
    const last = frame.storeys.at(-1);
    // Without a height the members of a storey stay for the next one.
    if (value.length) frame.storeys = value.map((height, i) => ({ ...JSON.parse(JSON.stringify(frame.storeys[i] ?? last)), height }));
    else frame.storeys = [{ ...last, height: null }];
    if (storey > frame.storeys.length) storey = 0;
    showTabs();
  } else if (path.startsWith("frame.")) putAt({ frame }, path, value);
  else for (const one of storey ? [frame.storeys[storey - 1]] : frame.storeys) putAt(one, path, value);
  lane.go();
  showAge();
  putLink();
}

// The frame stays in the address, as a link and when the page is loaded again.
function putLink() {
  window.history.replaceState(null, "", "#f=" + packed({ frame, units: system }));
}

function showTabs() {
  const names = ["all storeys", ...frame.storeys.map((_, i) => `storey ${i + 1}`)];
  get("storeys")?.replaceChildren(...names.map((name, i) => {
    const tab = element("button", { type: "button", className: "tab a", onclick: () => { choose(i); get("storeys").children[i].focus(); } }, name);
    tab.setAttribute("aria-pressed", String(i === storey));
    return tab;
  }));
}

function choose(level) {
  storey = level;
  showForm();
  show();
}

function showForm() {
  const row = field => fieldRow(valueOf(field.path) === null && !field.path.startsWith("frame.") ? { ...field, optional: storey ? "needed" : "differs" } : field, valueOf(field.path), system, value => edit(field.path, value), false);
  const group = (title, fields, ...before) => element("fieldset", {}, element("legend", {}, title), ...before, ...fields.map(row));
  get("form").replaceChildren(
    group("Grid", GRID), element("div", { id: "storeys", className: "tabs", role: "group", ariaLabel: "Storeys" }),
    group("Columns", MEMBERS[0][1]), group("Beams", MEMBERS[1][1]), group("All members", ALL), group("Loads", LOADS));
  showTabs();
  showMessages();
}

// ---- what is shown ---------------------------------------------------------------------------------

const lane = makeLane("frame", {
  question: () => ({ frame: JSON.parse(JSON.stringify(frame)) }),
  keep: true,
  take(found, body) {
    asked = { ...found, key: JSON.stringify(body.frame) };
    if (!found.faults.length) {
      answer = { ...asked, storeys: body.frame.storeys, bays: body.frame.bays };
      get("scrub").max = answer.pictures.length - 1;
      show();
    }
    showMessages();
    showAge();
  },
  fail(error) { get("notes").replaceChildren(element("p", { className: "fault" }, error instanceof TypeError ? "No answer: the server has ended. Start rbsdem explore again." : error.message)); },
});

const isOld = () => answer && answer.key !== JSON.stringify(frame);

function showAge() {
  for (const id of ["draw", "curve", "facts", "drifts", "hinges"]) get(id).classList.toggle("old", Boolean(isOld()));
}

function showMessages() {
  const faults = (asked?.faults ?? []).map(fault => ({ field: fault.field, text: toldAs(fault, FIELDS[fault.field], fault.field in FIELDS ? [valueOf(fault.field)].flat().filter(one => one !== null && one !== undefined) : null, system) }));
  const left = showFaults(get("form"), faults).map(text => element("p", { className: "fault" }, text));
  const notes = [asked?.stopped, ...(asked?.notes ?? [])].filter(Boolean).map(text => element("p", { className: "note" }, inUnits(text, system)));
  get("notes").replaceChildren(...left, ...notes);
  if (faults.length) get("live").textContent = faults.map(fault => fault.text).join("; ");
}

function show() {
  if (!answer) return;
  const at = Math.min(Number(get("scrub").value), answer.pictures.length - 1), row = answer.pictures[at];
  const [unit, factor] = unitOf(system, "force"), drift = Math.round(1e5 * answer.displacement[row] / answer.height) / 1e3;
  const text = `${shown(drift, 3)} %, base shear ${shown(answer.base_shear[row] / factor)} ${unit}`;
  get("scrubbed").textContent = text;
  get("scrub").setAttribute("aria-valuetext", text);
  drawFrame(get("drawing"), at);
  drawCurve(get("curvefigure"), row);
  showTables(at, row);
}

// The frame with its dead load, and beside it the frame on its way with its hinges.
function drawFrame(host, at) {
  const wide = answer.bays.reduce((sum, bay) => sum + bay, 0), high = answer.height, width = Math.max(300, host.clientWidth);
  const [unit, factor] = unitOf(system, "length"), moved = answer.moved[at], largest = Math.max(1e-12, ...answer.moved.at(-1).flat(2).map(Math.abs));
  // Room for the load at the left, for the displacements and the heights at the right.
  const times = Math.min(0.1 * Math.max(wide, high) / largest, 50), away = times * largest;
  const scale = Math.min((width - 132) / (wide + away), 380 / high), left = 60 + (width - 132 - (wide + away) * scale) / 2, top = 46, ground = top + high * scale;
  const legend = width < 460 ? 3 : 1, height = ground + 50 + 16 * legend, place = (member, point, far = times) =>
    [0, 1].map(i => answer.still[member][point][i] + far * moved[member][point][i]).map((value, i) => i ? ground - value * scale : left + value * scale);
  const path = (member, far) => answer.still[member].map((_, point) => (point ? "L" : "M") + place(member, point, far).map(value => value.toFixed(1)).join(" ")).join("");
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, width, height, class: "chart frames", role: "img", "aria-label": `Frame of ${answer.storeys.length} storeys and ${answer.bays.length} bays, displacements times ${shown(times, 2)}` });
  const storeyOf = name => Number(name.split("-")[2]);
  answer.members.forEach((name, i) => {
    svg.append(svgElement("path", { class: "zero", d: path(i, 0) }));
    const line = svgElement("path", { class: `member${storey && storeyOf(name) === storey ? " chosen" : ""}`, d: path(i, times) });
    line.addEventListener("click", () => choose(storeyOf(name) === storey ? 0 : storeyOf(name)));
    line.append(svgElement("title", {}, `${name}: click for the members of storey ${storeyOf(name)}`));
    svg.append(line);
    if (!name.startsWith("B")) return;
    const [[x0, y], [x1]] = [place(i, 0, 0), place(i, answer.still[i].length - 1, 0)];
    let load = `M${x0} ${y - 14}H${x1}`;
    for (let k = 1; k < 7; k++) load += `M${x0 + k * (x1 - x0) / 7} ${y - 14}v10m-2 -4l2 4l2 -4`;
    svg.append(svgElement("path", { class: "thin", d: load }));
  });
  let x = left, y = ground;
  for (const bay of [0, ...answer.bays]) {
    svg.append(svgElement("path", { class: "thin", d: `M${x += bay * scale} ${ground}m-11 0h22m-18 0l-4 5m9 -5l-4 5m9 -5l-4 5m9 -5l-4 5` }));
    if (bay) svg.append(svgElement("text", { x: x - bay * scale / 2, y: ground + 19, "text-anchor": "middle" }, `${shown(bay / factor)} ${unit}`));
  }
  for (const { height: own } of answer.storeys) {
    svg.append(svgElement("text", { x: left + (wide + away) * scale + 12, y: y - own * scale / 2 }, `${shown(own / factor)} ${unit}`));
    y -= own * scale;
    const force = 12 + 34 * (ground - y) / (high * scale);
    if (at) svg.append(svgElement("path", { class: "arrow", d: `M${left - 10 - force} ${y}h${force}m-6 -3.5l6 3.5l-6 3.5` }));
  }
  answer.springs.forEach(([member, share], i) => {
    const reached = answer.ductility[at][i], kind = HINGES.findLast(([least]) => reached >= least);
    if (!kind) return;
    // Beside the node, not on it.
    const last = answer.still[member].length - 1, [from, to, part] = share === 0 ? [0, 1, 0.35] : share === 1 ? [last, last - 1, 0.35] : [last / 2, last / 2, 0];
    const [a, b] = [place(member, from), place(member, to)];
    svg.append(svgElement("circle", { class: `hinge ${kind[1]}`, cx: (a[0] + part * (b[0] - a[0])).toFixed(1), cy: (a[1] + part * (b[1] - a[1])).toFixed(1), r: 4.2 },
      svgElement("title", {}, `${answer.members[member]}: ${shown(reached, 3)} times its rotation at yield`)));
  });
  HINGES.forEach(([, kind, words], i) => {
    const [x, y] = legend > 1 ? [8, ground + 38 + 16 * i] : [8 + 190 * i, ground + 38];
    svg.append(svgElement("circle", { class: `hinge ${kind}`, cx: x + 4, cy: y, r: 4.2 }), svgElement("text", { x: x + 13, y: y + 4 }, words));
  });
  svg.append(svgElement("text", { x: 4, y: height - 5 }, `Displacements × ${shown(times, 2)}; hinges by their largest rotation`));
  host.replaceChildren(svg);
}

function drawCurve(host, row) {
  const [unit, factor] = unitOf(system, "force"), [length, metre] = unitOf(system, "length");
  const drift = answer.displacement.map(value => 100 * value / answer.height), shear = answer.base_shear.map(value => value / factor);
  const marks = answer.events.filter(event => 100 * event.drift <= drift[row] + 1e-9).map(event => ({ x: 100 * event.drift, y: event.force / factor, shape: "circle", kind: "a", label: "a section yields", title: `${event.member}, ${event.end}` }));
  drawChart(host, { lines: [{ x: drift, y: shear, kind: "test thin", label: "the whole push" }, { x: drift.slice(0, row + 1), y: shear.slice(0, row + 1), kind: "a", label: "so far" }], marks, fromZero: true, legend: true, height: 330,
    xLabel: "Roof drift (%)", yLabel: `Base shear (${unit})`, top: { factor: answer.height / 100 / metre, label: `roof displacement (${length})` }, label: `Base shear against roof drift; largest ${shown(Math.max(...shear))} ${unit}` });
}

function showTables(at, row) {
  const [unit, factor] = unitOf(system, "force"), most = Math.max(...answer.base_shear), [first] = answer.events;
  const percent = value => `${shown(100 * value, 3)} %`;
  get("figures").replaceChildren(table(["", ""], [
    ["first period", answer.period === null ? "–" : `${shown(answer.period, 3)} s`], ["dead load", `${shown(answer.weight / factor)} ${unit}`], ["largest base shear", `${shown(most / factor)} ${unit}`],
    ["the same over the dead load", answer.weight ? shown(most / answer.weight, 3) : "–"], ["drift at the first yield", first ? (first.dead ? "under the dead load" : percent(first.drift)) : "–"],
    ["sections that yield so far", String(answer.ductility[at].filter(value => value >= 1).length)]].map(cells => ({ cells })), ""));
  get("drifttable").replaceChildren(table(["Storey", "drift %"], answer.storey_drift[at].map((value, i) => ({ cells: [String(i + 1), shown(100 * value, 3)] })).reverse(), `At a roof drift of ${percent(answer.displacement[row] / answer.height)}`));
  get("hingetable").replaceChildren(answer.events.length ? table(["Member", "section", "roof drift %", `base shear ${unit}`],
    answer.events.map(event => ({ kind: event.drift <= answer.displacement[row] / answer.height + 1e-9 ? "" : "later", cells: [event.member, ["start", "end"].includes(event.end) ? event.end : "middle", ...(event.dead ? ["dead load", "–"] : [shown(100 * event.drift, 3), shown(event.force / factor)])] })), "") : element("p", { className: "empty" }, "No section yields."));
}

// ---- what is done ----------------------------------------------------------------------------------

function push() {
  if (timer) { clearInterval(timer); timer = null; get("push").textContent = "Push"; return; }
  const scrub = get("scrub");
  if (scrub.value === scrub.max) scrub.value = 0;
  get("push").textContent = "Stop";
  timer = setInterval(() => {
    scrub.value = Number(scrub.value) + 1;
    show();
    if (scrub.value === scrub.max) push();
  }, 90);
}

async function save(id, name, form) {
  if (!answer || isOld()) { get("live").textContent = "Nothing is saved: the input has errors."; return; }
  await saveShown(get(id), name, form);
  get("live").textContent = `Saved ${name}.${form}`;
}

async function begin() {
  for (const [key, { label }] of Object.entries(SYSTEMS)) get("units").append(element("option", { value: key }, label));
  get("units").addEventListener("change", () => { system = get("units").value; showForm(); show(); putLink(); });
  get("form").addEventListener("submit", event => event.preventDefault());
  get("scrub").addEventListener("input", show);
  get("push").addEventListener("click", push);
  get("case").addEventListener("click", () => { if (answer && !isOld()) download("frame.nml", answer.case, "text/plain"); });
  for (const [id, name, forms] of [["draw", "frame", ["svg", "png"]], ["curve", "pushover", ["csv", "svg", "png"]], ["facts", "frame_figures", ["csv"]], ["drifts", "storey_drifts", ["csv"]], ["hinges", "hinges", ["csv"]]]) {
    addSaves(get(id), name, forms, form => save(id, name, form));
    get(id).querySelector("h2").append(element("span", { className: "age" }, "for an earlier input"));
  }
  let wait = null;
  window.addEventListener("resize", () => { clearTimeout(wait); wait = setTimeout(show, 120); });
  const linked = location.hash.startsWith("#f=") ? unpackedFrame(location.hash.slice(3)) : null;
  if (linked && SYSTEMS[linked.units]) system = linked.units;
  get("units").value = system;
  frame = linked?.frame ?? (await (await fetch("start")).json()).frame;
  showForm();
  lane.go();
}

begin();
