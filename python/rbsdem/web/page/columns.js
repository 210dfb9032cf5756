// The view of columns: drawings side by side, their loops, sections, bands and tests.

import { inUnits, shown, unitOf } from "./units.js";
import { drawColumn, scalesOf } from "./drawing.js";
import { LOADING_FIELDS, element, fieldGroup, fieldRow, fieldsOf, groupOf, isShaken, isText, loadingRows, loadingValue, nameOf, placeOf, putAt, putLoading, refreshFields, showFaults, toldAs, valuesOf } from "./fields.js";
import { SECTION_FIELDS, SECTION_KEYS, completeSection, sectionRows, sectionValue, shapeOf } from "./section.js";
import { codeTable, curvatureChart, interactionChart, loopChart, nameOfState, nearCards, rowsOfNear, scaleChart, stateTables, timeChart } from "./panels.js";
import { beside, changed, copied, edit, fixed, get, keyOf, page, say, showNotes, showStatus } from "./machine.js";

let active = 0, scalesDrawn = [], chart = null;

const loops = () => columnsView.stood.loops?.columns ?? [];
const besideLoops = name => beside(name, columnsView)?.columns ?? null;
const isMotion = () => loops().some(loop => loop.dynamic);
const cases = () => columnsView.state.cases;

const COLUMN = [
  { path: "column.top", label: "Ends", choices: [["free", "cantilever"], ["fixed", "double curvature"]] },
  { path: "column.height", label: "Height", dimension: "length", step: 0.05 },
  { path: "column.axial_load", label: "Axial load, compression +", dimension: "force", step: 1e4 },
  { path: "column.top_mass", label: "Mass at the top", dimension: "mass", step: 1e3, optional: "axial load / g", motion: true },
  { path: "footing.kind", label: "Foot", choices: [["none", "rigid ground"], ["springs", "footing on springs"]] },
  { path: "flexure.k", label: "Springs against turning", dimension: "turning", step: 1e7, footing: true },
  { path: "shear.k", label: "Springs against sliding", dimension: "stiffness", step: 1e7, footing: true },
  { path: "column.footing_height", label: "Height of the footing", dimension: "length", step: 0.05, footing: true },
  { path: "column.footing_mass", label: "Mass of the footing", dimension: "mass", step: 1e3, footing: true },
];
const COLUMN_SHAPES = ["rectangle", "circle", "hollow_rectangle", "hollow_circle", "wall"];
const KNOWN = fieldsOf([...SECTION_KEYS, ...COLUMN, ...LOADING_FIELDS]);
const FIELDS = [...SECTION_FIELDS.flatMap(({ fields }) => fields).filter(field => field.path), ...COLUMN, ...LOADING_FIELDS];
const onSprings = groups => Boolean(groupOf(groups, "flexure"));

export const columnsView = {
  name: "columns", label: "columns", scrubs: "loops",
  titles: { draw: "Drawing", loops: "Lateral force and drift", states: "Limit states", timepanel: "Drift in time" },
  panels: { loops: ["loops", "summary", "states", "history"], sections: ["curvature", "interaction", "codes"], near: ["near"] },
  codeOf: name => name === "sections" ? get("code").value : undefined,
  accepts: answer => answer.columns.every(loop => loop.displacement),
  exported: () => ({ column: active }),
  rowsOf: id => id === "near" ? rowsOfNear(columnsView.stood.near.state, columnsView.stood.near) : null,
  settle() { active = Math.min(active, cases().length - 1); },
  begin() { columnsView.settle(); },
  put,
  refresh() { refreshFields(get("form"), FIELDS, valueOf, page.system); },
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

function valueOf(path) {
  const groups = cases()[active];
  if (isText(groups)) return null;
  if (path.startsWith("loading.")) return loadingValue(groups, path.slice(8));
  if (path === "footing.kind") return onSprings(groups) ? "springs" : "none";
  return sectionValue(groups, path);
}

function put(path, value) {
  const groups = cases()[active];
  if (path === "text") cases()[active] = value;
  else if (path.startsWith("loading.")) {
    // Columns side by side have one loading.
    for (const one of cases()) if (!isText(one)) putLoading(one, path.slice(8), value);
  } else if (path === "footing.kind") setFooting(groups, value === "springs");
  else if (!completeSection(groups, groups, path, value)) putAt(groups, path, value);
  if (path.startsWith("column.footing_")) setInertia(valuesOf(groups, "column"));
}

// A footing, as soft as the column itself, so that it shows; or none.
function setFooting(groups, springs) {
  const column = valuesOf(groups, "column");
  for (const name of ["shear", "flexure"]) if (groupOf(groups, name)) groups.splice(groups.indexOf(groupOf(groups, name)), 1);
  if (springs) {
    groups.splice(groups.indexOf(groupOf(groups, "column")) + 1, 0, ["shear", { joint: [0], rule: "elastic", k: 1e9 }], ["flexure", { joint: [0], rule: "elastic", k: 1e8 }]);
    column.footing_height = 0.6;
    column.footing_mass = 4e3;
    setInertia(column);
  } else for (const name of ["height", "mass", "inertia"]) delete column[`footing_${name}`];
}

// The rotary inertia of a block of concrete with a square plan.
function setInertia(column) {
  const { footing_height: height, footing_mass: mass } = column;
  if (height > 0 && mass > 0) column.footing_inertia = mass * (mass / (2400 * height) + height ** 2) / 12;
  else delete column.footing_inertia;
}

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
    const name = loops().length > 1 ? `${nameOf(columnsView.stood.loops.state, i)}: ` : "";
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
  timeChart(get("timefigure"), loops().map((loop, i) => loop?.time && { time: loop.time, drift: loop.displacement.map(value => value / loop.height), name: nameOf(of, i) }));
  scaleChart(get("scalefigure"), of, scales);
  get("scales").hidden = of.cases.every(isText);
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
  get("draw").hidden = state.cases.every(isText);
  const focused = document.activeElement?.dataset?.path && host.contains(document.activeElement) ? [document.activeElement.closest("[data-column]").dataset.column, document.activeElement.dataset.path] : null;
  while (host.children.length > state.cases.length) host.lastChild.remove();
  state.cases.forEach((groups, i) => {
    let box = host.children[i];
    if (!box) { box = element("div", { className: "drawbox" }); host.append(box); }
    box.dataset.column = i;
    if (isText(groups)) { box.replaceChildren(element("p", { className: "empty" }, `Column ${nameOf(state, i)} is a case file: nothing is drawn here.`)); return; }
    const column = drawingOf(groups);
    if (!page.dragging) scalesDrawn[i] = scalesOf(column);
    const newest = latest?.columns[i];
    drawColumn(box, column, newest?.figure, { system, scales: scalesDrawn[i] ?? scalesOf(column), kind: "ab"[i], title: nameOf(state, i), fixed, stale: latest?.key !== keyOf(state) || Boolean(newest?.faults.length),
      move: (path, value, done) => { choose(i); edit(path, value, done, true); }, moved: (path, begins = false) => { page.dragging = begins; if (!begins) showDrawings(); } });
  });
  if (focused) host.querySelector(`[data-column="${focused[0]}"] [data-path="${focused[1]}"]`)?.focus();
}

function showMessages() {
  const { latest } = columnsView, { system } = page, newest = latest?.columns ?? [], of = latest?.state;
  const all = newest.flatMap((loop, i) => loop.faults.map(fault => ({ ...fault, told: isText(of.cases[i]) ? fault.text : toldAs(fault, KNOWN, of.cases[i], system), column: i })));
  const left = showFaults(get("form"), all.filter(fault => fault.column === active));
  const notes = [], named = i => newest.length > 1 ? `Column ${nameOf(latest.state, i)}: ` : "";
  for (const fault of all.filter(one => one.column !== active && !all.some(other => other.column === active && other.told === one.told))) left.push(named(fault.column) + fault.told);
  newest.forEach((loop, i) => {
    if (loop.stopped) notes.push(named(i) + inUnits(loop.stopped, system));
    if (loop.status === "axial_failure") notes.push(named(i) + "the column can no longer carry its axial load; the loop ends there");
    for (const text of loop.notes) notes.push(named(i) + inUnits(text, system));
  });
  showNotes(left, notes);
  if (latest && latest.key !== keyOf(columnsView.state)) return;
  if (all.length) say([...new Set(all.map(fault => fault.told))].join("; "));
  else {
    const last = newest.flatMap(loop => loop.states ?? []).map(at => `${nameOfState(at.name)} at ${shown(100 * Math.abs(at.drift), 2)} %`);
    if (!page.dragging && newest[0]?.figures) say(`Largest force ${shown(newest[0].figures.peak_force / unitOf(system, "force")[1])} ${unitOf(system, "force")[0]}. ${last.join(", ")}`);
  }
}

function showTabs() {
  const host = get("tabs"), { state } = columnsView;
  host.ariaLabel = "Columns";
  host.replaceChildren();
  state.cases.forEach((_, i) => {
    const tab = element("button", { type: "button", className: "tab " + "ab"[i] }, `Column ${nameOf(state, i)}`);
    tab.setAttribute("aria-pressed", String(i === active));
    tab.addEventListener("click", () => { choose(i); host.children[i].focus(); });
    host.append(tab);
  });
  if (fixed) return;
  const add = element("button", { type: "button", id: "second" }, state.cases.length > 1 ? "Remove B" : "Compare with a second column");
  add.addEventListener("click", () => {
    if (state.cases.length > 1) { state.cases.pop(); active = 0; }
    else {
      const second = copied(state.cases[0]);
      if (!isText(second)) putAt(second, "case.title", "B");
      state.cases.push(second);
      active = 1;
    }
    changed(true);
    get("second").focus();
  });
  host.append(add);
}

function showForm() {
  showTabs();
  const groups = cases()[active], { system } = page;
  if (isText(groups)) {
    const text = element("textarea", { id: "f-case", value: groups, rows: 14, spellcheck: false, readOnly: fixed });
    text.setAttribute("aria-describedby", "f-case-fault");
    text.dataset.path = "";
    text.addEventListener("input", () => edit("text", text.value, false));
    text.addEventListener("change", () => edit("text", text.value, true));
    const row = element("div", { className: "row wide" }, element("label", { htmlFor: "f-case" }, "Case file"), text, element("p", { className: "fault", id: "f-case-fault", hidden: true }));
    get("form").replaceChildren(...fieldGroup("Column and loading of a case file", [row]));
  } else {
    const rows = COLUMN.filter(field => (!field.motion || isShaken(groups)) && (!field.footing || onSprings(groups)))
      .map(field => fieldRow(field, valueOf(field.path), system, (value, done) => edit(field.path, value, done), fixed, placeOf(groups, field.path)));
    const act = change => { change(); changed(true); };
    get("form").replaceChildren(...sectionRows(groups, groups, { system, edit, act, fixed, shapes: COLUMN_SHAPES }), ...fieldGroup("Column", rows),
      ...fieldGroup(cases().length > 1 ? "Loading of both columns" : "Loading", loadingRows(groups, system, edit, fixed, LOADING_FIELDS)));
  }
  showMessages();
}

function choose(i) {
  if (i === active) return;
  active = i;
  showForm();
}

// What is drawn of a column: its first groups by their names.
function drawingOf(groups) {
  const found = name => ({ ...valuesOf(groups, name) });
  const section = { ...found("section"), shape: shapeOf(groups) };
  return { section, concrete: found("concrete"), layout: groupOf(groups, "layout") && found("layout"), column: found("column"), footed: onSprings(groups) };
}

// Whether a value changes what there is to be filled in.
function complete(path) {
  return ["section.shape", "bars.kind", "footing.kind", "loading.kind"].includes(path);
}

if (!fixed) get("code").addEventListener("change", () => columnsView.lanes.sections.go());
