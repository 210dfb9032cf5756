// The view of columns: drawings side by side, their loops, sections, bands and tests.

import { inUnits, shown, unitOf } from "./units.js";
import { drawColumn, scalesOf } from "./drawing.js";
import { COLUMN_FIELDS, LOADINGS, LOADING_FIELDS, drawForm, element, putAt, refreshFields, showFaults, toldOf, valueAt } from "./fields.js";
import { codeTable, curvatureChart, interactionChart, loopChart, nameOfState, nearCards, rowsOfNear, scaleChart, stateTables, timeChart } from "./panels.js";
import { beside, changed, copied, edit, fixed, get, keyOf, page, say, showNotes, showStatus } from "./machine.js";

let active = 0, scalesDrawn = [], chart = null;

const loops = () => columnsView.stood.loops?.columns ?? [];
const besideLoops = name => beside(name, columnsView)?.columns ?? null;
const isMotion = () => loops().some(loop => loop.dynamic);
const group = value => value && typeof value === "object" && !Array.isArray(value) ? value : {};

export const columnsView = {
  name: "columns", label: "columns", scrubs: "loops",
  titles: { draw: "Drawing", loops: "Lateral force and drift", states: "Limit states", timepanel: "Drift in time" },
  panels: { loops: ["loops", "summary", "states", "history"], sections: ["curvature", "interaction", "codes"], near: ["near"] },
  codeOf: name => name === "sections" ? get("code").value : undefined,
  accepts: answer => answer.columns.every(loop => loop.displacement),
  exported: () => ({ column: active }),
  rowsOf: id => id === "near" ? rowsOfNear(columnsView.stood.near.state, columnsView.stood.near) : null,
  isState: ({ columns }) => Array.isArray(columns) && columns.length >= 1 && columns.length <= 2 && columns.every(one => one && typeof one === "object"),
  // A state with all its groups.
  tidied: ({ columns, loading }) => ({ columns: columns.map((column, i) => {
    const name = String(column.name ?? "AB"[i]);
    if ("case" in column) return { name, case: String(column.case) };
    const { section, concrete, bars, ties, column: frame, footing } = column;
    return { name, section: { ...group(section), shape: String(section?.shape ?? "rectangle") }, concrete: group(concrete), bars: group(bars), ties: group(ties), column: group(frame), ...(footing ? { footing: group(footing) } : {}) };
  }), loading }),
  settle() { active = Math.min(active, columnsView.state.columns.length - 1); },
  begin() { columnsView.settle(); },
  put(path, value) { putAt(path.startsWith("loading.") ? columnsView.state : columnsView.state.columns[active], path, value); },
  refresh() { refreshFields(get("form"), [...COLUMN_FIELDS.flatMap(({ fields }) => fields), ...LOADING_FIELDS], valueOf, page.system); },
  resized() { columnsView.showLoops(); showSections(); },
  showAll() { columnsView.showForm(); columnsView.showDrawings(); columnsView.showLoops(); showSections(); showNear(); columnsView.showMessages(); },
  complete, showDrawings, showForm, showLoops, showMessages, showPoint, showStatus: showState,
};

export const columnLanes = [
  { lane: "sections", delay: 60, show: showSections, more: () => ({ code: get("code").value }) },
  { lane: "bands", delay: 140, show: showLoops, asks: () => !isMotion() },
  { lane: "scales", delay: 300, show: showTime, asks: isMotion },
  { lane: "own", delay: 450, show: showSections },
  { lane: "nearest", name: "near", delay: 250, show: showNear, asks: () => page.withTests },
];

const valueOf = path => valueAt(path.startsWith("loading.") ? columnsView.state : columnsView.state.columns[active], path);

// ---- what is shown ---------------------------------------------------------------------------------

function showLoops() {
  const { stood } = columnsView;
  if (!stood.loops) {
    get("loopfigure").replaceChildren(element("p", { className: "empty" }, "No loop: see the messages beside the fields."));
    for (const id of ["statetable", "figures"]) get(id).replaceChildren();
    return;
  }
  const bands = besideLoops("bands"), of = stood.loops.state;
  chart = loopChart(get("loopfigure"), of, loops(), bands, page.system);
  stateTables(get("statetable"), get("figures"), of, loops(), bands, page.system);
  const scrub = get("scrub");
  scrub.disabled = false;
  scrub.max = loops()[0].displacement.length - 1;
  showPoint(Number(scrub.value) > 0);
  showState();
  showTime();
}

function showState() {
  const words = [], bands = besideLoops("bands");
  loops().forEach((loop, i) => {
    const name = loops().length > 1 ? `${columnsView.stood.loops.state.columns[i].name}: ` : "";
    const seconds = loop.seconds ? ` in ${Math.max(1, Math.round(1e3 * loop.seconds))} ms` : "";
    words.push(`${name}${loop.model ? loop.model + ", " : ""}${loop.displacement.length} points${seconds}`);
  });
  if (!isMotion() && words.length) {
    if (bands?.some(band => band.lower)) words.push("shaded: band of 80 % of the points of tests that the model had not seen");
    else if (bands) words.push(bands[0].none ?? "");
    else if (!fixed) words.push("computing the band");
  }
  showStatus(words);
}

function showPoint(visible = true) {
  const [loop] = loops();
  if (!loop || !chart) return;
  const at = Math.min(Number(get("scrub").value), loop.displacement.length - 1);
  const [unit, factor] = unitOf(page.system, "force"), drift = 100 * loop.displacement[at] / loop.height, force = loop.force[at] / factor;
  if (visible) chart.moveCursor(drift, force);
  const text = `drift ${shown(drift, 3)} %, force ${shown(force)} ${unit}` + (loop.time ? `, ${shown(loop.time[at])} s` : "");
  get("scrubbed").textContent = visible ? text : "";
  get("scrub").setAttribute("aria-valuetext", text);
}

function showTime() {
  get("history").hidden = !isMotion();
  get("scales").hidden = false;
  if (!isMotion()) return;
  const of = columnsView.stood.loops.state, scales = besideLoops("scales") ?? [];
  timeChart(get("timefigure"), loops().map((loop, i) => loop?.time && { time: loop.time, drift: loop.displacement.map(value => value / loop.height), name: of.columns[i].name }));
  scaleChart(get("scalefigure"), of, scales);
  get("scales").hidden = of.columns.every(one => "case" in one);
  get("scalestate").textContent = scales.some(one => one.scales) ? "Crosses: collapse or axial failure" : "Computing other scales of the motion";
}

function showSections() {
  const { stood } = columnsView, found = stood.sections;
  if (!found) return;
  const same = name => stood[name]?.key === found.key ? stood[name].columns : null;
  curvatureChart(get("curvaturefigure"), found.state, found.columns, page.system);
  interactionChart(get("interactionfigure"), found.state, found.columns, same("own"), same("loops"), page.system, get("code").selectedOptions[0].textContent);
  codeTable(get("codetable"), found.state, found.columns, page.system);
  for (const name of ["curvature", "interaction", "codes"]) get(name).hidden = found.columns.every(one => !one.code);
}

function showNear() {
  const { near } = columnsView.stood;
  get("near").hidden = !near?.columns;
  if (!near?.columns) return;
  get("nearstate").textContent = `Of ${near.tests} tests; grey: test, line: prediction`;
  nearCards(get("neartests"), near.state, near, page.system);
}

function showDrawings() {
  const host = get("drawings"), { state, latest } = columnsView, { system } = page;
  get("draw").hidden = state.columns.every(one => "case" in one);
  const focused = document.activeElement?.dataset?.path && host.contains(document.activeElement) ? [document.activeElement.closest("[data-column]").dataset.column, document.activeElement.dataset.path] : null;
  while (host.children.length > state.columns.length) host.lastChild.remove();
  state.columns.forEach((column, i) => {
    let box = host.children[i];
    if (!box) { box = element("div", { className: "drawbox" }); host.append(box); }
    box.dataset.column = i;
    if ("case" in column) { box.replaceChildren(element("p", { className: "empty" }, `Column ${column.name} is a case file: nothing is drawn here.`)); return; }
    if (!page.dragging) scalesDrawn[i] = scalesOf(column);
    const newest = latest?.columns[i];
    drawColumn(box, column, newest?.figure, { system, scales: scalesDrawn[i] ?? scalesOf(column), kind: "ab"[i], title: column.name, fixed, stale: latest?.key !== keyOf(state) || Boolean(newest?.faults.length),
      move: (path, value, done) => { choose(i); edit(path, value, done, true); }, moved: (path, begins = false) => { page.dragging = begins; if (!begins) showDrawings(); } });
  });
  if (focused) host.querySelector(`[data-column="${focused[0]}"] [data-path="${focused[1]}"]`)?.focus();
}

function showMessages() {
  const { latest } = columnsView, { system } = page, newest = latest?.columns ?? [], of = latest?.state;
  const all = newest.flatMap((loop, i) => loop.faults.map(fault => ({ field: fault.field, text: toldOf(fault, of, of.columns[i], system), column: i })));
  const left = showFaults(get("form"), all.filter(fault => fault.column === active));
  const notes = [], named = i => newest.length > 1 ? `Column ${latest.state.columns[i].name}: ` : "";
  for (const fault of all.filter(one => one.column !== active && !one.field.startsWith("loading."))) left.push(named(fault.column) + fault.text);
  newest.forEach((loop, i) => {
    if (loop.stopped) notes.push(named(i) + inUnits(loop.stopped, system));
    if (loop.status === "axial_failure") notes.push(named(i) + "the column can no longer carry its axial load; the loop ends there");
    for (const text of loop.notes) notes.push(named(i) + inUnits(text, system));
  });
  showNotes(left, notes);
  if (all.length) say([...new Set(all.map(fault => fault.text))].join("; "));
  else {
    const last = newest.flatMap(loop => loop.states ?? []).map(at => `${nameOfState(at.name)} at ${shown(100 * Math.abs(at.drift), 2)} %`);
    if (!page.dragging && newest[0]?.figures) say(`Largest force ${shown(newest[0].figures.peak_force / unitOf(system, "force")[1])} ${unitOf(system, "force")[0]}. ${last.join(", ")}`);
  }
}

function showTabs() {
  const host = get("tabs"), { state } = columnsView;
  host.ariaLabel = "Columns";
  host.replaceChildren();
  state.columns.forEach((column, i) => {
    const tab = element("button", { type: "button", className: "tab " + "ab"[i] }, `Column ${column.name || "AB"[i]}`);
    tab.setAttribute("aria-pressed", String(i === active));
    tab.addEventListener("click", () => { choose(i); host.children[i].focus(); });
    host.append(tab);
  });
  if (fixed) return;
  const add = element("button", { type: "button", id: "second" }, state.columns.length > 1 ? "Remove B" : "Compare with a second column");
  add.addEventListener("click", () => {
    if (state.columns.length > 1) { state.columns.pop(); active = 0; }
    else { state.columns.push({ ...copied(state.columns[0]), name: "B" }); active = 1; }
    changed(true);
    get("second").focus();
  });
  host.append(add);
}

function showForm() {
  showTabs();
  drawForm(get("form"), columnsView.state, active, page.system, edit, fixed);
  showMessages();
}

function choose(i) {
  if (i === active) return;
  active = i;
  showForm();
}

// A choice brings the values that it needs.
function complete(path) {
  const { state } = columnsView, column = state.columns[active], { section } = column;
  if (path === "section.shape") {
    const round = section.shape.includes("circle"), size = round ? section.width : section.diameter;
    if (round) section.diameter ??= size ?? 0.5;
    else { section.width ??= size ?? 0.4; section.depth ??= size ?? 0.4; }
    if (section.shape.startsWith("hollow")) section.wall ??= Number((0.25 * (round ? section.diameter : Math.min(section.width, section.depth))).toPrecision(3));
    return true;
  }
  if (path === "footing.kind") {
    // As soft as the column itself is a footing that shows.
    if (column.footing.kind === "springs") { column.footing.rotation ??= 1e8; column.footing.sliding ??= 1e9; column.footing.height ??= 0.6; column.footing.mass ??= 4e3; }
    return true;
  }
  if (path === "loading.kind") {
    state.loading = copied(LOADINGS[state.loading.kind] ?? { kind: state.loading.kind });
    return true;
  }
  return false;
}

if (!fixed) get("code").addEventListener("change", () => columnsView.lanes.sections.go());
