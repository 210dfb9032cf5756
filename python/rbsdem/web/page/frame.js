// The view of a frame: a building drawn by its sections, pushed, moved to and fro, or shaken.

import { inUnits, shown, unitOf } from "./units.js";
import { drawChart, svgElement } from "./chart.js";
import { drawSection } from "./drawing.js";
import { ALONG_Y, LOADING_FIELDS, drawingsOf, element, fieldGroup, fieldRow, fieldsOf, groupOf, listRows, loadingRows, loadingValue, placeOf, putAt, putLoading, refreshFields, showFaults, toldAs, valuesOf } from "./fields.js";
import { SECTION_FIELDS, SECTION_KEYS, completeSection, sectionRows, sectionValue, shapeOf } from "./section.js";
import { table, timeChart } from "./panels.js";
import { beside, changed, copied, edit, get, keyOf, page, say, showNotes, showStatus } from "./machine.js";

const GRID = [
  { path: "frame.storeys", label: "Heights of the storeys, from the ground", dimension: "length", list: true },
  { path: "frame.bays", label: "Widths of the bays", dimension: "length", list: true },
  { path: "frame.base", label: "Base of the columns", choices: [["fixed", "fixed"], ["pinned", "pinned"]] },
];
const IN_PLAN = [
  GRID[0],
  { path: "frame.bays_x", label: "Widths of the bays along x", dimension: "length", list: true },
  { path: "frame.bays_y", label: "Widths of the bays along y", dimension: "length", list: true },
  GRID[2],
  { path: "frame.direction", label: "Direction of the push, from x towards y, in degrees", dimension: "number", step: 15, optional: "0" },
  ...["x", "y"].map(along => ({ path: `frame.eccentricity_${along}`, label: `Centre of mass off along ${along}`, dimension: "share", step: 0.05, optional: "0" })),
];
const LOADS = [
  { path: "frame.live_share", label: "Share of the live load that acts", dimension: "share", step: 0.05, optional: "30" },
  { path: "frame.self_weight", label: "Weight of the members", choices: [[false, "in the dead load"], [true, "25 kN/m³"]] },
  { path: "frame.mass", label: "Masses of the floors", choices: [["of_floors", "as given"], ["from_loads", "of the loads"]] },
  { path: "frame.kinematics", label: "P-Delta", choices: [["small", "off"], ["pdelta", "on"]] },
  { path: "damping.modal", label: "Damping of all modes", dimension: "share", step: 0.01, several: true, optional: "none" },
];
const DEMAND = [
  { path: "target.spectrum", label: "Spectrum", choices: [["en_1998", "EN 1998"], ["asce_41", "ASCE 41-17"]] },
  { path: "target.ag", label: "Acceleration on rock, in g", dimension: "ratio", step: 0.05, spectrum: "en_1998" },
  { path: "target.soil", label: "Ground", choices: ["A", "B", "C", "D", "E"].map(soil => [soil, soil]), usual: "B", spectrum: "en_1998" },
  { path: "target.s_xs", label: "S_XS, in g", dimension: "ratio", step: 0.05, spectrum: "asce_41" },
  { path: "target.s_x1", label: "S_X1, in g", dimension: "ratio", step: 0.05, spectrum: "asce_41" },
  { path: "target.method", label: "Target displacement by", choices: [["en_1998", "N2 of EN 1998-1"], ["asce_41", "coefficients, ASCE 41-17"], ["capacity_spectrum", "capacity spectrum"]] },
  { path: "assess.code", label: "Limits of members by", choices: [["en_1998_3", "EN 1998-3"], ["asce_41", "ASCE 41-17"]] },
  { path: "assess.level", label: "Level to be kept", choices: [] },
];
const LEVELS = { en_1998_3: ["DL", "SD", "NC"], asce_41: ["IO", "LS", "CP"] };
const SPECTRA = { en_1998: { ag: 0.25, soil: "C" }, asce_41: { s_xs: 1.0, s_x1: 0.6 } };
const [KIND, ...REST] = LOADING_FIELDS;
const LOADING = [{ ...KIND, choices: [["push", "push to one side"], ...KIND.choices] }, ...REST];
const PATTERN = { path: "frame.pattern", label: "Lateral load as", choices: [["triangular", "mass times height"], ["uniform", "mass"], ["modal", "first mode"]] };
const NAME = { path: "drawing.name", label: "Name", text: true };
const FRAME_SHAPES = ["rectangle", "tee", "wall", "circle", "hollow_rectangle", "hollow_circle"];
// Lists of groups by their names; a place is a line, a bay, a storey or a floor.
const load = (key, label, dimension, step) => ({ key, label, dimension, step, optional: "0" });
const INFILL = [
  { key: "name", label: "name", text: true }, { key: "thickness", label: "thick", dimension: "length", step: 0.01 }, { key: "fm", label: "f_m", dimension: "stress", step: 1e6 },
  { ...load("opening_length", "opening", "length", 0.1), optional: "–" }, { ...load("opening_height", "its height", "length", 0.1), optional: "–" },
];
const PLACED = fieldsOf(["line", "bay", "storey", "floor", "kind", "kind_to", "lines", "bays", "line_x", "line_y", "along", "of_line"].flatMap(key => ["column_of", "beam_of", "infill_of", "node_load", "floor"].map(name => ({ path: `${name}.${key}`, label: key, choices: [] }))));
const FIELDS = [GRID, IN_PLAN, LOADS, DEMAND, [PATTERN, NAME], [...LOADING, ALONG_Y], SECTION_FIELDS.flatMap(({ fields }) => fields).filter(field => field.path)].flat();
const KNOWN = { ...PLACED, ...fieldsOf([...FIELDS, ...SECTION_KEYS, ...INFILL.map(cell => ({ ...cell, path: `infill.${cell.key}` })),
  { path: "floor.dead_load", label: "Dead load", dimension: "line" }, { path: "floor.live_load", label: "Live load", dimension: "line" }, { path: "floor.edge_load", label: "Facades", dimension: "line" },
  { path: "floor.floor_load", label: "Dead load", dimension: "area" }, { path: "floor.live_floor_load", label: "Live load", dimension: "area" }, { path: "node_load.load", label: "Load", dimension: "force" }]) };
// Hinges by the furthest that they have reached, and ends by the levels of the code that they exceed.
const STATES = [["cracking", "cracked", "cracked"], ["yield", "yielded", "yielded"], ["cap", "beyond", "failed or beyond their cap"], ["shear_failure", "beyond"], ["lost", "beyond"]];
const EXCEEDED = ["within", "yielded", "far", "beyond"];

// The name of the drawing that is shown, "" for the building; the member that was chosen; whether levels are shown; the frame of a plan.
let shownDrawing = "", line = "x-1", chosen = "", byLevels = false, timer = null, scales = {}, timeFigure = null;

// Of a building in plan the response is that of the frame which is shown.
function answer() {
  const found = frameView.stood.loops?.frame;
  if (!found?.frames) return found;
  if (!found.frames[line]) [line] = Object.keys(found.frames);
  return { ...found, ...found.frames[line] };
}
// Ends beside their limits, of the frame that is shown.
const endsShown = () => (checks()?.ends ?? []).filter(({ member }) => !inPlan() || member.startsWith(`${line}:`)).map(one => ({ ...one, member: one.member.split(":").at(-1) }));
const checks = () => beside("checks", frameView);
const groups = () => frameView.state.cases[0];
const drawings = () => drawingsOf(groups()).map(own => [own[0][1].name ?? "", own]);
const own = () => drawings().find(([name]) => name === shownDrawing)?.[1] ?? groups();

export const frameView = {
  name: "frame", label: "frames", scrubs: "building",
  titles: { draw: "Sections", loops: "Base shear and roof drift", states: "Limit states of members", timepanel: "Storey drifts in time" },
  panels: { loops: ["building", "loops", "summary", "storeys", "states", "history"], checks: ["members"] },
  accepts: found => Boolean(found.frame.displacement),
  settle() { if (!drawings().some(([name]) => name === shownDrawing)) shownDrawing = ""; },
  begin() { frameView.settle(); },
  put, complete, showDrawings, showForm, showMessages, showPoint: () => { byLevels = false; showPoint(); },
  showLoops: showResponse, showStatus: showState,
  refresh() { refreshFields(get("form"), FIELDS, valueOf, page.system); },
  resized: showResponse,
  showAll() { showForm(); showDrawings(); showResponse(); showMessages(); },
};

export const frameLanes = [{ lane: "checks", delay: 60, show: showChecks }];

// ---- the grid --------------------------------------------------------------------------------------

const inPlan = (frame = valuesOf(groups(), "frame")) => "bays_x" in frame;
const baysKey = frame => inPlan(frame) ? `bays_${line[0]}` : "bays";
const sizes = key => { const found = valuesOf(groups(), "frame")[key]; return Array.isArray(found) ? found : [found ?? 0]; };

// Whether a group of a grid is of a place, and which of those that are so comes last: it counts.
function fits(values, place, lines) {
  return Object.entries(place).every(([key, at]) => {
    const word = values[`${key}s`] ?? "all", outer = at === 1 || at === lines;
    return word === "all" ? [undefined, 0, at].includes(values[key]) : (word === "outer") === outer;
  });
}
const isNone = one => one[1].kind === "none";

function placesOf(name) {
  const [what, ...numbers] = name.split("-"), [at, storey] = numbers.map(Number), column = what === "C", group = column ? "column_of" : "beam_of";
  const lines = sizes(baysKey()).length + (column ? 1 : 0), along = line[0], across = Number(line.slice(2));
  const ofPlan = column ? (along === "x" ? { line_x: at, line_y: across } : { line_x: across, line_y: at }) : { along, bay: at, of_line: across };
  const place = { ...(inPlan() ? ofPlan : { [column ? "line" : "bay"]: at }), storey };
  // A wall stands in place of columns.
  const found = groups().filter(([own, values]) => own === group && fits(values, place, lines)).sort((a, b) => column ? Boolean(a[1].along) - Boolean(b[1].along) : 0);
  return { group, place, found };
}
const drawingOf = name => /^[CB]-/.test(name) ? placesOf(name).found.at(-1)?.[1].kind ?? "" : "";

function removedMembers() {
  const names = [], bays = sizes(baysKey()).length;
  sizes("storeys").forEach((_, k) => {
    for (let i = 1; i <= bays + 1; i++) names.push(`C-${i}-${k + 1}`);
    for (let i = 1; i <= bays; i++) names.push(`B-${i}-${k + 1}`);
  });
  return names.filter(name => drawingOf(name) === "none");
}

function remove(name) {
  const { group, place, found } = placesOf(name), last = found.at(-1), all = groups();
  const after = one => all.splice((all.findLastIndex(([own]) => own === group) + 1) || 1, 0, one);
  chosen = name;
  if (group === "column_of" && last?.[1].along) all.splice(all.indexOf(last), 1);
  else if (!last || !isNone(last)) after([group, { ...place, kind: "none" }]);
  else if (Object.entries(place).every(([key, at]) => last[1][key] === at)) all.splice(all.indexOf(last), 1);
  else after([group, { ...place, kind: found.findLast(one => !isNone(one))?.[1].kind ?? drawings()[0]?.[0] }]);
  changed(true);
}

// ---- the form --------------------------------------------------------------------------------------

function valueOf(path) {
  if (path.startsWith("loading.")) return loadingValue(groups(), path.slice(8));
  return sectionValue(own(), path);
}

function put(path, value) {
  const all = groups();
  if (path.startsWith("loading.")) {
    putLoading(all, path.slice(8), value);
    if (path === "loading.kind" && value === "push") putAt(all, "loading.values", [Number((0.03 * sizes("storeys").reduce((sum, one) => sum + (Number(one) || 0), 0)).toPrecision(3))]);
  } else if (path === "drawing.name") rename(value);
  else if (path === "target.spectrum") {
    if (!groupOf(all, "target")) all.push(["target", { method: value }]);
    const target = valuesOf(all, "target"), { method } = target;
    for (const key of Object.keys(target)) delete target[key];
    Object.assign(target, { method, spectrum: value }, SPECTRA[value]);
  } else {
    if (path === "assess.code") putAt(all, "assess.level", null);
    if (!shownDrawing || !completeSection(all, own(), path, value)) putAt(all, path, value, own());
  }
  frameView.settle();
}

function complete(path) {
  return ["loading.kind", "target.spectrum", "assess.code", "section.shape", "bars.kind"].includes(path);
}

// Whatever is of a drawing goes with its name.
function rename(value) {
  const before = shownDrawing, [drawing] = own();
  if (!value || drawings().some(([name]) => name === value)) return;
  drawing[1].name = value;
  for (const [, values] of groups()) for (const key of ["kind", "kind_to", "panel_hoops"]) if (values[key] === before) values[key] = value;
  shownDrawing = value;
}

// A section like the one that is shown, or the last.
function addDrawing() {
  const all = groups(), names = drawings().map(([name]) => name), from = shownDrawing ? own() : drawings().at(-1)?.[1];
  if (!from) return;
  const stem = from[0][1].name.replace(/\d+$/, "") || "S";
  let number = 1;
  while (names.includes(stem + number)) number++;
  const made = copied(from);
  made[0][1].name = stem + number;
  all.splice(all.indexOf(drawings().at(-1)[1].at(-1)) + 1, 0, ...made);
  shownDrawing = stem + number;
  chosen = "";
  changed(true);
}

// A drawing that no member has any more.
function dropDrawing() {
  const gone = own(), all = groups();
  const left = all.filter(one => !gone.includes(one) && one[1].kind !== shownDrawing && one[1].kind_to !== shownDrawing);
  shownDrawing = "";
  all.splice(0, all.length, ...left);
  changed(true);
}

function showTabs() {
  const host = get("tabs"), names = ["building", ...drawings().map(([name]) => name)];
  host.ariaLabel = "Building and its sections";
  host.replaceChildren(...names.map((name, i) => {
    const tab = element("button", { type: "button", className: "tab a", onclick: () => { choose(i ? name : ""); host.children[i].focus(); } }, name);
    tab.setAttribute("aria-pressed", String(i ? name === shownDrawing : !shownDrawing));
    return tab;
  }), element("button", { type: "button", id: "add-section", disabled: !drawings().length, onclick: addDrawing }, "Add a section"));
  if (shownDrawing) host.append(element("button", { type: "button", id: "drop-section", disabled: drawings().length < 2, onclick: dropDrawing }, `Remove ${shownDrawing}`));
}

function choose(name, member = "") {
  shownDrawing = name;
  chosen = member;
  frameView.settle();
  showForm();
  showDrawings();
  showPoint();
}

const act = change => { change(); changed(true); };

// Cells of the rules that say where what is: a line or bay, a storey, and what is there.
function placeCells(key, kinds, level = "storey") {
  const count = sizes("bays").length + (key === "line" ? 1 : 0), numbers = Array.from({ length: count }, (_, i) => [String(i + 1), String(i + 1)]);
  const word = `${key}s`;
  return [
    { key, label: key, choices: [["0", "all"], ["outer", "outer"], ["inner", "inner"], ...numbers],
      get: values => ["outer", "inner"].includes(values[word]) ? values[word] : String(values[key] ?? 0),
      set: (values, chosenPlace) => { delete values[word]; delete values[key]; if (/\d/.test(chosenPlace)) { if (chosenPlace !== "0") values[key] = Number(chosenPlace); } else values[word] = chosenPlace; } },
    levelCell(level),
    ...(kinds ? [{ key: "kind", label: "is", choices: [...kinds.map(kind => [kind, kind]), ["none", "none"]] }] : []),
  ];
}

const levelCell = level => numberCell(level, level, sizes("storeys").length);

function numberCell(key, label, count) {
  return { key, label, choices: [["0", "all"], ...Array.from({ length: count }, (_, i) => [String(i + 1), String(i + 1)])], get: values => String(values[key] ?? 0),
    set: (values, number) => { delete values[key]; if (number !== "0") values[key] = Number(number); } };
}

// The same of a grid in plan, whose places are lines across x and y, or bays of a line.
function planCells(group, kinds) {
  const [x, y] = ["bays_x", "bays_y"].map(key => sizes(key).length), is = { key: "kind", label: "is", choices: [...kinds, "none"].map(kind => [kind, kind]) };
  const along = { key: "along", label: "along", choices: [["x", "x"], ["y", "y"]] };
  if (group !== "column_of") return [along, numberCell("bay", "bay", Math.max(x, y)), numberCell("of_line", "line", Math.max(x, y) + 1), levelCell("storey"), is];
  const wall = { ...along, label: "wall", choices: [["", "no"], ["x", "along x"], ["y", "along y"]], get: values => values.along ?? "", set: (values, way) => { delete values.along; if (way) values.along = way; } };
  return [numberCell("line_x", "at x", x + 1), numberCell("line_y", "at y", y + 1), wall, levelCell("storey"), is];
}

// The planar frame as the first of lines along x, with lines across it.
function setInPlan() {
  const all = groups(), frame = valuesOf(all, "frame"), bays = sizes("bays"), own = { column_of: ["line", bays.length + 1], beam_of: ["bay", bays.length], infill_of: ["bay", bays.length] };
  const each = all.flatMap(one => {
    const [name, { dead_load, live_load, ...values }] = one, [key, last] = own[name] ?? [], word = values[`${key}s`];
    if (name === "node_load") return [];
    if (name === "floor") return [[name, { ...values, ...(dead_load && { floor_load: 6e3 }), ...(live_load && { live_floor_load: 2e3 }) }]];
    if (!key) return [one];
    const places = word === "outer" ? [1, last] : word === "inner" ? Array.from({ length: Math.max(0, last - 2) }, (_, i) => i + 2) : [values[key]];
    const ways = key === "line" ? [{}] : [{ along: "x" }, ...(places[0] || name === "infill_of" ? [] : [{ along: "y" }])];
    delete values[`${key}s`];
    delete values[key];
    return ways.flatMap(way => places.map(at => [name, { ...way, ...values, ...(at && { [key === "line" ? "line_x" : key]: at }) }]));
  });
  delete frame.bays;
  delete frame.wall_spans;
  Object.assign(frame, { bays_x: bays, bays_y: [bays[0]] });
  all.splice(0, all.length, ...each);
}

function showForm() {
  const all = groups(), { system } = page, about = { groups: all, system, edit, act, fixed: false };
  const rows = (fields, is = () => true) => fields.filter(is).map(field => fieldRow(field, valueOf(field.path), system, (value, done) => edit(field.path, value, done), false, placeOf(all, field.path, own())));
  showTabs();
  if (shownDrawing) {
    get("form").replaceChildren(...fieldGroup("Section of members", rows([NAME])), ...sectionRows(all, own(), { system, edit, act, fixed: false, shapes: FRAME_SHAPES }));
    showMessages();
    return;
  }
  const kinds = drawings().map(([name]) => name), infills = all.filter(([name]) => name === "infill").map(one => one[1].name), { spectrum } = valuesOf(all, "target") ?? {}, code = valuesOf(all, "assess")?.code ?? "en_1998_3";
  const list = (name, cells, more) => listRows(name, cells, { ...about, ...more });
  const levels = LEVELS[code].map(level => [level, level]).reverse();
  const plan = inPlan(), along = plan && { along: "x" }, setPlan = element("button", { type: "button", id: "setinplan", onclick: () => act(setInPlan) }, "Set it in plan, with lines along x and y");
  const cells = (group, names) => plan ? planCells(group, names) : placeCells(group === "column_of" ? "line" : "bay", names);
  const loads = plan ? [load("floor_load", "dead", "area", 500), load("live_floor_load", "live", "area", 500), load("edge_load", "facade", "line", 1e3)] : [load("dead_load", "dead", "line", 1e3), load("live_load", "live", "line", 1e3)];
  get("form").replaceChildren(...[
    ["Grid", plan ? rows(IN_PLAN) : [...rows(GRID), setPlan]],
    ["Columns and walls, the last that fits counts", list("column_of", cells("column_of", kinds), { what: "columns", least: 1, add: () => ({ ...(plan ? { line_x: 1 } : { lines: "outer" }), kind: kinds[0] }) })],
    ["Beams, the last that fits counts", list("beam_of", cells("beam_of", kinds), { what: "beams", add: () => ({ ...along, kind: kinds.at(-1) }) })],
    [plan ? "Loads on floors and outer beams" : "Loads on beams of floors", list("floor", [levelCell("floor"), ...loads, load("mass", "mass", "mass", 1e3)], { what: "floor loads", add: last => ({ ...last, floor: 1 }) })],
    ["Loads on nodes, as of facades", plan ? [] : list("node_load", [...placeCells("line", null, "floor"), { key: "load", label: "weight", dimension: "force", step: 1e3 }], { what: "node loads", add: () => ({ lines: "outer", load: 25e3 }) })],
    ["Loads and masses", rows(LOADS)],
    ["Masonry", [...list("infill", INFILL, { what: "masonry", add: last => ({ ...(last ?? { thickness: 0.2, fm: 3e6 }), name: `I${infills.length + 1}` }) }),
      ...(infills.length ? list("infill_of", cells("infill_of", infills), { what: "infills", add: () => ({ ...along, kind: infills.at(-1) }) }) : [])]],
    ["Loading", [...loadingRows(all, system, edit, false, plan ? [...LOADING, ALONG_Y] : LOADING), ...rows([PATTERN])]],
    ["Demand and acceptance", rows(DEMAND.map(field => field.path === "assess.level" ? { ...field, choices: levels } : field), field => !field.spectrum || field.spectrum === spectrum)],
  ].flatMap(([title, made]) => fieldGroup(title, made)));
  showMessages();
}

// The section of the tab; on that of the building all of them.
function showDrawings() {
  const host = get("drawings"), { state, latest } = frameView, shownOnes = drawings().filter(([name]) => !shownDrawing || name === shownDrawing);
  get("draw").hidden = !shownOnes.length;
  const focused = host.contains(document.activeElement) ? document.activeElement : null, path = focused?.dataset.path, from = focused?.closest("[data-column]").dataset.column;
  while (host.children.length > shownOnes.length) host.lastChild.remove();
  shownOnes.forEach(([name, of], i) => {
    if (!host.children[i]) host.append(element("div", { className: "drawbox" }));
    host.children[i].dataset.column = name;
    const figure = latest?.frame.sections[name], drawing = { section: { ...valuesOf(of, "section"), shape: shapeOf(of) }, layout: valuesOf(of, "layout") };
    scales[name] = drawSection(host.children[i], drawing, figure, { system: page.system, title: name, kind: "a", stale: latest?.key !== keyOf(state) || !figure, scale: page.dragging ? scales[name] : undefined,
      move: (at, value, done) => { if (shownDrawing !== name) choose(name, chosen); edit(at, value, done, true); }, moved: (at, begins = false) => { page.dragging = begins; if (!begins) showDrawings(); } });
  });
  if (path) host.querySelector(`[data-column="${from}"] [data-path="${path}"]`)?.focus();
}

// ---- what is shown ---------------------------------------------------------------------------------

function showState() {
  const found = answer();
  showStatus(found ? [`${found.members.length} members`, `${found.displacement.length} rows in ${Math.max(1, Math.round(1e3 * found.seconds))} ms`, found.stopped ? "ended early" : found.status] : []);
}

function showMessages() {
  const { latest, state } = frameView, { system } = page, of = latest?.state.cases[0];
  const all = [...latest?.frame.faults ?? [], ...(latest?.frame.displacement ? checks()?.faults ?? [] : [])].map(fault => ({ ...fault, told: toldAs(fault, KNOWN, of, system) }));
  const notes = [...new Set([latest?.frame.stopped, ...(latest?.frame.notes ?? [])])].filter(Boolean).map(text => inUnits(text, system));
  showNotes(showFaults(get("form"), all), notes);
  // What is half typed is not told.
  if (latest?.key === keyOf(state)) say([...new Set(all.map(fault => fault.told))].join("; "));
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
  // How many ends and joints exceed what asks for them, and how many no code covers.
  const over = found?.limits_of && [[found.level, `exceed ${found.level}`], ["shear", "exceed their strength in shear"], ["not evaluated", "are not evaluated"]].filter(([key]) => found.counts[key]).map(([key, words]) => `${found.counts[key]} ${words}`);
  const told = found?.limits_of && `${found.limits_of}: ${found.accepted ? "accepted" : "not accepted"} at ${found.level}${over.length ? `, as ${over.join(", ")}` : ""}. Ratios of ${found.levels.at(-1)}, ${found.at_target ? "at the target displacement" : "largest of all rows"}${(found.notes ?? []).map(one => `. ${one}`).join("")}`;
  get("membertable").replaceChildren(ends.length ? table(["Member", "end", "ratio", "levels exceeded", "by"], ends.slice(0, 12).map(one => ({ cells: [one.member, one.end, one.status === "evaluated" ? shown(one.ratio, 3) : "–", found.levels.slice(0, Math.max(0, one.exceeded)).join(", ") || "none", { text: one.status === "evaluated" ? one.governed_by : one.status }] })), told)
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
  drawPlan(get("plan"), found, at);
  drawFrame(get("frame"), found, at);
  drawCurve(get("loopfigure"), found, row);
  if (found.dynamic) timeFigure.moveCursor(found.time[row], 100 * found.storey_drift[row][0]);
  showTables(found, row);
  tell(chosen);
}

// Forces of a member in the row that is shown, and its demand over its capacity.
function tell(name) {
  const found = answer(), i = found?.members.indexOf(name) ?? -1, removed = Boolean(name) && drawingOf(name) === "none";
  get("remove").disabled = !name;
  get("remove").textContent = removed ? `Put ${name} back` : name ? `Remove ${name}` : "Remove the member";
  if (i < 0) { get("told").textContent = removed ? `${name} is removed` : "A member under the pointer tells its forces; a click chooses it"; return; }
  const [force, newton] = unitOf(page.system, "force"), [moment, per] = unitOf(page.system, "moment"), at = Math.min(Number(get("scrub").value), found.pictures.length - 1);
  const [axial, first, last, shear] = found.forces[at][i], ratio = Math.max(-1, ...endsShown().filter(one => one.member === name && one.status === "evaluated").map(one => one.ratio));
  get("told").textContent = `${name}: N ${shown(axial / newton, 3)} ${force}, V ${shown(shear / newton, 3)} ${force}, M ${shown(first / per, 3)} and ${shown(last / per, 3)} ${moment}` + (ratio < 0 ? "" : `; demand over capacity ${shown(ratio, 3)}`);
}

// Hinges that were reached so far, or ends by the levels of the code: place and class.
function hingesOf(found, row) {
  const reached = new Map(), words = new Map();
  if (byLevels) for (const { member, end, exceeded } of endsShown()) reached.set(`${member} ${end}`, [member, end, EXCEEDED[exceeded] ?? "unknown"]);
  else for (const { member, end, name, time, group } of found.events) {
    const kind = STATES.findIndex(([state]) => state === name), key = `${member} ${end}`;
    if (time > found.time[row] || kind < 0 || kind < (words.get(key) ?? 0)) continue;
    words.set(key, kind);
    reached.set(key, [member, group === "member" ? "0.5" : end, STATES[kind][1]]);
  }
  return reached.values();
}

// The lines of a building where they stand, and the roof on its way: a click shows the frame of a line.
function drawPlan(host, found, at) {
  host.hidden = !found.frames;
  if (host.hidden) return;
  const { lines, roof, centre } = found.plan, xs = lines.flatMap(one => [one.from[0], one.to[0]]), ys = lines.flatMap(one => [one.from[1], one.to[1]]);
  const [west, east, south, north] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)], wide = Math.max(east - west, 1), high = Math.max(north - south, 1);
  const turned = ([x, y], [u, v, t], times) => [x + times * (u - t * (y - centre[1])), y + times * (v + t * (x - centre[0]))];
  const corners = [[west, south], [east, north]], away = roof.flatMap(way => corners.map(corner => Math.hypot(...turned(corner, way, 1).map((value, k) => value - corner[k]))));
  const times = 0.12 * Math.max(wide, high) / Math.max(1e-9, ...bounded(away, Math.max)), width = Math.max(300, host.clientWidth), scale = Math.min(0.6 * width / wide, 170 / high), height = high * scale + 76;
  const put = point => [width / 2 + (point[0] - (west + east) / 2) * scale, height / 2 - (point[1] - (south + north) / 2) * scale].map(value => value.toFixed(1));
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, width, height, class: "chart frames", role: "group", "aria-label": `Plan of ${lines.length} frames; the roof moves, displacements times ${shown(times, 2)}` });
  const focused = host.contains(document.activeElement) ? document.activeElement.dataset?.name : null;
  for (const { name, from, to } of lines) {
    const path = ends => "M" + ends.map(end => put(end).join(" ")).join("L"), [x, y] = put(from), show = () => { line = name; chosen = ""; showPoint(); };
    svg.append(svgElement("path", { class: "zero", d: path([from, to]) }), svgElement("text", name[0] === "x" ? { x: x - 34, y: Number(y) + 4 } : { x, y: Number(y) + 24, "text-anchor": "middle" }, name));
    const way = svgElement("path", { class: `member${name === line ? " chosen" : ""}`, d: path([from, to].map(end => turned(end, roof[at], times))), role: "button", tabindex: 0, "data-name": name, "aria-pressed": String(name === line), "aria-label": `Frame ${name}` });
    way.addEventListener("click", show);
    way.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); show(); } });
    svg.append(way);
  }
  host.replaceChildren(svg);
  if (focused) svg.querySelector(`[data-name="${focused}"]`)?.focus();
}

// The frame with its dead load, and the frame on its way with its hinges.
function drawFrame(host, found, at) {
  const given = valuesOf(frameView.stood.loops.state.cases[0], "frame"), levels = given.storeys, bays = given[baysKey(given)], removed = removedMembers().filter(name => !found.members.includes(name)), row = found.pictures[at];
  const wide = bays.reduce((sum, bay) => sum + bay, 0), high = found.height, width = Math.max(300, host.clientWidth);
  const [unit, factor] = unitOf(page.system, "length"), moved = found.moved[at];
  const ways = found.moved.flatMap(members => members.map(line => line.map(([x]) => x))).flat(), least = Math.min(0, ...bounded(ways, Math.min)), largest = Math.max(1e-12, ...bounded(ways, Math.max));
  // Room for the load at the left, for the displacements and the heights at the right.
  const times = Math.min(0.1 * Math.max(wide, high) / Math.max(largest, -least), 50), away = times * largest, before = -times * least;
  const scale = Math.min((width - 132) / (wide + away + before), 380 / high), left = 60 + before * scale + (width - 132 - (wide + away + before) * scale) / 2, top = 46, ground = top + high * scale;
  const legend = byLevels ? ["within all", ...(checks()?.levels ?? []).map(level => `exceeds ${level}`)].map((text, i) => [EXCEEDED[i], text]) : STATES.slice(0, 3).map(([, kind, text]) => [kind, text]);
  const narrow = width < 460, height = ground + 50 + 16 * (narrow ? legend.length : 1);
  const put = ([x, y]) => [left + x * scale, ground - y * scale], place = (i, point, far = times) => put([0, 1].map(k => found.still[i][point][k] + far * moved[i][point][k]));
  const path = (i, far) => found.still[i].map((_, point) => (point ? "L" : "M") + place(i, point, far).map(value => value.toFixed(1)).join(" ")).join("");
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, width, height, class: "chart frames", role: "group", "aria-label": `Frame ${found.frames ? `${line} ` : ""}of ${levels.length} storeys and ${bays.length} bays, displacements times ${shown(times, 2)}. Arrow keys go from member to member, Delete removes one.` });
  const focused = host.contains(document.activeElement) ? document.activeElement.dataset?.name : null;
  const axes = bays.reduce((all, bay) => [...all, all.at(-1) + bay], [0]), floors = levels.reduce((all, one) => [...all, all.at(-1) + one], [0]);
  const member = (name, d, words, kind = "") => {
    const line = svgElement("path", { class: `member${chosen === name || (shownDrawing && !chosen && drawingOf(name) === shownDrawing) ? " chosen" : ""}${kind}`, d, role: "button", tabindex: name === (chosen || found.members[0]) ? 0 : -1, "data-name": name, "aria-label": words });
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
    member(name, path(i, times), `${name}, ${drawingOf(name) || "no section"}`);
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
  levels.forEach((own, i) => {
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
  svg.append(svgElement("text", { x: 4, y: height - 5 }, `Displacements × ${shown(times, 2)}${byLevels ? "; ends by the levels that they exceed" : ""}`));
  svg.addEventListener("keydown", event => keyed(event, found.members.concat(removed)));
  host.replaceChildren(svg);
  if (focused) svg.querySelector(`[data-name="${focused}"]`)?.focus();
}

// A limit state with what reached it: flexure or shear.
const stateOf = ({ group, name }) => ["member", ""].includes(group) || name.startsWith(group) ? name.replaceAll("_", " ") : `${group.replaceAll("_", " ")}: ${name.replaceAll("_", " ")}`;

// Least or largest of many numbers, for which a call has no room.
function bounded(values, of) {
  return [values.reduce((best, value) => of(best, value), 0)];
}

function pick(name) {
  const found = drawingOf(name);
  if (chosen === name) choose("");
  else choose(drawings().some(([own]) => own === found) ? found : shownDrawing, name);
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
  get("statetable").replaceChildren(events.length ? table(["Member", "section", "limit state", ...(found.dynamic ? ["time s"] : []), "roof drift %", `base shear ${unit}`], events.slice(0, 60).map(event => ({ kind: event.time <= found.time[row] ? "" : "later",
    cells: [event.member, ["start", "end", ""].includes(event.end) ? event.end : shown(Number(event.end), 2), stateOf(event), ...(found.dynamic ? [shown(event.time, 4)] : []), ...(event.dead ? ["dead load", "–"] : [shown(100 * event.drift, 3), shown(event.force / factor)])] })), events.length > 60 ? `${events.length - 60} more in the report` : "") : element("p", { className: "empty" }, "No section yields."));
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

// The picture nearest to the target displacement, with the levels that each end exceeds there.
function goToTarget() {
  const found = answer(), { signed } = checks().target, away = found.pictures.map(row => Math.abs(found.displacement[row] - signed));
  get("scrub").value = away.indexOf(Math.min(...away));
  byLevels = true;
  showPoint();
}

get("play").addEventListener("click", play);
get("attarget").addEventListener("click", goToTarget);
get("remove").addEventListener("click", () => remove(chosen));
