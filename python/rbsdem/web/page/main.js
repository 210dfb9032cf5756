// The page: one state, what it shows of it, and what it asks.

import { SYSTEMS, inUnits, shown, unitOf } from "./units.js";
import { drawColumn, scalesOf } from "./drawing.js";
import { LOADINGS, drawForm, element, putAt, refreshFields, showFaults, toldOf } from "./fields.js";
import { addSaves, codeTable, curvatureChart, download, interactionChart, loopChart, nameOfState, nearCards, rowsOfNear, saveShown, scaleChart, stateTables, timeChart } from "./panels.js";
import { makeHistory, packed, unpacked } from "./history.js";
import { ask, makeLane } from "./answers.js";

const get = id => document.getElementById(id);
const inside = get("report");
const report = inside ? JSON.parse(inside.textContent) : null;
const fixed = report !== null;
let state = null, active = 0, system = "mm", withTests = false, note = "", defect = "";
let scalesDrawn = [], chart = null, dragging = false;
// What stands on the page: answers to one accepted input. Each knows its input, and is old where that is not the present one.
const stood = { loops: null, sections: null, bands: null, scales: null, own: null, near: null };
// The newest answer of the loops, whose input may be refused.
let latest = null;
const PANELS = { loops: ["loops", "summary", "states", "history"], sections: ["curvature", "interaction", "codes"], near: ["near"] };

const keyOf = ({ columns, loading }) => JSON.stringify([columns, loading]);
const sent = () => ({ state: JSON.parse(JSON.stringify({ columns: state.columns, loading: state.loading })) });
const loops = () => stood.loops?.columns ?? [];
// The columns of an answer that belongs to the loops that stand.
const beside = name => stood[name]?.key === stood.loops?.key ? stood[name]?.columns ?? null : null;
const codeOf = name => name === "sections" ? get("code").value : undefined;
const isOld = name => Boolean(stood[name]) && (stood[name].key !== keyOf(state) || stood[name].code !== codeOf(name));
const isMotion = () => loops().some(loop => loop.dynamic);

function say(text) {
  if (get("live").textContent !== text) get("live").textContent = text;
}

// ---- what is asked ---------------------------------------------------------------------------------

function gone(error) {
  defect = error instanceof TypeError ? "No answer: the server has ended. Start rbsdem explore again." : error.message;
  showStatus();
}

// All but the loops are asked of the input that was accepted.
const slow = (name, delay, show, { asks = () => true, more = () => ({}) } = {}) => makeLane(name, {
  question: () => stood.loops && asks() ? { state: stood.loops.state, ...more() } : null,
  take: (answer, body) => { stand(LANES[name], answer, body); show(); },
  fail: gone, delay,
});
const LANES = { sections: "sections", bands: "bands", scales: "scales", own: "own", nearest: "near" };
const lanes = fixed ? {} : {
  loops: makeLane("loops", { question: sent, take: takeLoops, fail: gone, keep: true }),
  sections: slow("sections", 60, showSections, { more: () => ({ code: get("code").value }) }),
  bands: slow("bands", 140, showLoops, { asks: () => !isMotion() }),
  scales: slow("scales", 300, showTime, { asks: isMotion }),
  own: slow("own", 450, showSections),
  nearest: slow("nearest", 250, showNear, { asks: () => withTests }),
};

function askAll() {
  lanes.loops.go();
  showAge();
}

function stand(name, answer, { state: of, code }) {
  stood[name] = { ...answer, state: of, key: keyOf(of), code };
  showAge();
}

function takeLoops(answer, body) {
  defect = "";
  latest = { ...answer, state: body.state, key: keyOf(body.state) };
  // One column that is refused leaves all as it was: what stands belongs to one input.
  if (answer.columns.every(loop => loop.displacement)) {
    stand("loops", answer, body);
    showLoops();
    for (const [lane, name] of Object.entries(LANES)) {
      if (stood[name]?.key !== stood.loops.key || stood[name].code !== codeOf(name)) lanes[lane].go();
      else lanes[lane].stop();
    }
  }
  showAge();
  showStatus();
  showDrawings();
  showMessages();
}

// ---- what is shown ---------------------------------------------------------------------------------

// Marks what belongs to an earlier input.
function showAge() {
  for (const [name, panels] of Object.entries(PANELS)) for (const id of panels) get(id).classList.toggle("old", isOld(name));
}

function showLoops() {
  if (!stood.loops) { get("loopfigure").replaceChildren(element("p", { className: "empty" }, "No loop: see the messages beside the fields.")); return; }
  const bands = beside("bands"), of = stood.loops.state;
  chart = loopChart(get("loopfigure"), of, loops(), bands, system);
  stateTables(get("statetable"), get("figures"), of, loops(), bands, system);
  const scrub = get("scrub");
  scrub.disabled = false;
  scrub.max = loops()[0].displacement.length - 1;
  showPoint(Number(scrub.value) > 0);
  showStatus();
  showTime();
}

function showStatus() {
  const words = [], bands = beside("bands");
  if (latest && latest.key === keyOf(state) && latest.key !== stood.loops?.key) words.push(stood.loops ? "The input is refused; the results shown belong to the last valid input" : "");
  else {
    loops().forEach((loop, i) => {
      const name = loops().length > 1 ? `${stood.loops.state.columns[i].name}: ` : "";
      const seconds = loop.seconds ? ` in ${Math.max(1, Math.round(1e3 * loop.seconds))} ms` : "";
      words.push(`${name}${loop.model ? loop.model + ", " : ""}${loop.displacement.length} points${seconds}`);
    });
    if (!isMotion() && words.length) {
      if (bands?.some(band => band.lower)) words.push("shaded: band of 80 % of the points of tests that the model had not seen");
      else if (bands) words.push(bands[0].none ?? "");
      else if (!fixed) words.push("computing the band");
    }
  }
  get("loopstate").textContent = defect || words.filter(Boolean).join(" · ");
  get("loopstate").classList.toggle("fault", Boolean(defect));
}

function showPoint(visible = true) {
  const [loop] = loops();
  if (!loop || !chart) return;
  const at = Math.min(Number(get("scrub").value), loop.displacement.length - 1);
  const [unit, factor] = unitOf(system, "force"), drift = 100 * loop.displacement[at] / loop.height, force = loop.force[at] / factor;
  if (visible) chart.moveCursor(drift, force);
  const text = `drift ${shown(drift, 3)} %, force ${shown(force)} ${unit}` + (loop.time ? `, ${shown(loop.time[at])} s` : "");
  get("scrubbed").textContent = visible ? text : "";
  get("scrub").setAttribute("aria-valuetext", text);
}

function showTime() {
  get("history").hidden = !isMotion();
  if (!isMotion()) return;
  const of = stood.loops.state, scales = beside("scales") ?? [];
  timeChart(get("timefigure"), of, loops());
  scaleChart(get("scalefigure"), of, scales);
  get("scales").hidden = of.columns.every(one => "case" in one);
  get("scalestate").textContent = scales.some(one => one.scales) ? "Crosses: collapse or axial failure" : "Computing other scales of the motion";
}

function showSections() {
  const found = stood.sections;
  if (!found) return;
  const same = name => stood[name]?.key === found.key ? stood[name].columns : null;
  curvatureChart(get("curvaturefigure"), found.state, found.columns, system);
  interactionChart(get("interactionfigure"), found.state, found.columns, same("own"), same("loops"), system, get("code").selectedOptions[0].textContent);
  codeTable(get("codetable"), found.state, found.columns, system);
  for (const name of ["curvature", "interaction", "codes"]) get(name).hidden = found.columns.every(one => !one.code);
}

function showNear() {
  const { near } = stood;
  get("near").hidden = !near?.columns;
  if (!near?.columns) return;
  get("nearstate").textContent = `Of ${near.tests} tests; grey: test, line: prediction`;
  nearCards(get("neartests"), near.state, near, system);
}

function showDrawings() {
  const host = get("drawings");
  get("draw").hidden = state.columns.every(one => "case" in one);
  const focused = document.activeElement?.dataset?.path && host.contains(document.activeElement) ? [document.activeElement.closest("[data-column]").dataset.column, document.activeElement.dataset.path] : null;
  while (host.children.length > state.columns.length) host.lastChild.remove();
  state.columns.forEach((column, i) => {
    let box = host.children[i];
    if (!box) { box = element("div", { className: "drawbox" }); box.dataset.column = i; host.append(box); }
    if ("case" in column) { box.replaceChildren(element("p", { className: "empty" }, `Column ${column.name} is a case file: nothing is drawn here.`)); return; }
    if (!dragging) scalesDrawn[i] = scalesOf(column);
    const heard = latest?.columns[i];
    drawColumn(box, column, heard?.figure, { system, scales: scalesDrawn[i] ?? scalesOf(column), kind: "ab"[i], title: column.name, fixed, stale: latest?.key !== keyOf(state) || Boolean(heard?.faults.length),
      move: (path, value, done) => { choose(i); edit(path, value, done, true); }, moved: (path, begins = false) => { dragging = begins; if (!begins) showDrawings(); } });
  });
  if (focused) host.querySelector(`[data-column="${focused[0]}"] [data-path="${focused[1]}"]`)?.focus();
}

function showMessages() {
  const heard = latest?.columns ?? [], of = latest?.state;
  const all = heard.flatMap((loop, i) => loop.faults.map(fault => ({ field: fault.field, text: toldOf(fault, of, of.columns[i], system), column: i })));
  const left = showFaults(get("form"), all.filter(fault => fault.column === active));
  const lines = [], named = i => heard.length > 1 ? `Column ${latest.state.columns[i].name}: ` : "";
  for (const text of left) lines.push(element("p", { className: "fault" }, text));
  for (const fault of all.filter(one => one.column !== active && !one.field.startsWith("loading."))) lines.push(element("p", { className: "fault" }, named(fault.column) + fault.text));
  heard.forEach((loop, i) => {
    if (loop.stopped) lines.push(element("p", { className: "note" }, named(i) + inUnits(loop.stopped, system)));
    if (loop.status === "axial_failure") lines.push(element("p", { className: "note" }, named(i) + "the column can no longer carry its axial load; the loop ends there"));
    for (const text of loop.notes) lines.push(element("p", { className: "note" }, named(i) + inUnits(text, system)));
  });
  if (note) lines.push(element("p", { className: "note" }, note));
  get("notes").replaceChildren(...lines);
  if (all.length) say(all.map(fault => fault.text).join("; "));
  else {
    const last = heard.flatMap(loop => loop.states ?? []).map(at => `${nameOfState(at.name)} at ${shown(100 * Math.abs(at.drift), 2)} %`);
    if (!dragging && heard[0]?.figures) say(`Largest force ${shown(heard[0].figures.peak_force / unitOf(system, "force")[1])} ${unitOf(system, "force")[0]}. ${last.join(", ")}`);
  }
}

function showTabs() {
  const host = get("columns");
  host.replaceChildren();
  state.columns.forEach((column, i) => {
    const tab = element("button", { type: "button", className: "tab " + "ab"[i] }, `Column ${column.name || "AB"[i]}`);
    tab.setAttribute("aria-pressed", String(i === active));
    tab.addEventListener("click", () => { choose(i); get("columns").children[i].focus(); });
    host.append(tab);
  });
  if (fixed) return;
  const add = element("button", { type: "button", id: "second" }, state.columns.length > 1 ? "Remove B" : "Compare with a second column");
  add.addEventListener("click", () => {
    if (state.columns.length > 1) { state.columns.pop(); active = 0; }
    else { state.columns.push({ ...JSON.parse(JSON.stringify(state.columns[0])), name: "B" }); active = 1; }
    changed(true);
    get("second").focus();
  });
  host.append(add);
}

function showForm() {
  showTabs();
  drawForm(get("form"), state, active, system, (path, value, done) => edit(path, value, done), { fixed, openRecord: () => get("recordfile").click() });
  showMessages();
}

function choose(i) {
  if (i === active) return;
  active = i;
  showForm();
}

function showAll() {
  showForm();
  showDrawings();
  showLoops();
  showSections();
  showNear();
  showMessages();
}

// ---- what is done ----------------------------------------------------------------------------------

function complete(path) {
  // A shape brings the sizes that it needs.
  const column = state.columns[active], { section } = column;
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
    state.loading = JSON.parse(JSON.stringify(LOADINGS[state.loading.kind] ?? { kind: state.loading.kind }));
    return true;
  }
  return false;
}

function edit(path, value, done, redraw = false) {
  const target = path.startsWith("loading.") ? state : state.columns[active];
  putAt(target, path, value);
  const other = complete(path);
  note = "";
  if (other) { changed(true); return; }
  if (redraw) refreshFields(get("form"), state, active, system);
  showDrawings();
  askAll();
  if (done) keep();
}

function keep() {
  if (past.commit({ columns: state.columns, loading: state.loading })) putLink();
}

function putLink() {
  const link = "#s=" + packed({ state: { columns: state.columns, loading: state.loading }, units: system });
  window.history.replaceState(null, "", link);
}

// After a change of what there is, not only of a number.
function changed(commit) {
  if (!fixed) askAll();
  showForm();
  showDrawings();
  if (commit) keep();
}

const past = makeHistory((back, forth) => {
  get("undo").disabled = !back;
  get("redo").disabled = !forth;
});

function restore(found) {
  if (!found) return;
  state = found;
  active = Math.min(active, state.columns.length - 1);
  changed(false);
  putLink();
}

function load(found, units, words = "") {
  state = found;
  active = 0;
  note = words;
  if (units && SYSTEMS[units]) system = units;
  get("units").value = system;
  changed(true);
}

async function save(form) {
  const answer = fixed ? report.exports[form] : await ask("export", { ...sent(), form, column: active });
  if (!answer?.text) { refuseToSave(); return; }
  const ending = { namelist: "nml", python: "py", csv: "csv" }[form];
  download(`${answer.name}.${ending}`, answer.text, "text/plain");
  say(`Saved ${answer.name}.${ending}`);
}

// What a panel shows, if it belongs to the present input.
async function savePanel(host, name, form) {
  const [panel] = Object.entries(PANELS).find(([, ids]) => ids.includes(host.closest("section").id)) ?? ["loops"];
  if (isOld(panel) || !stood.loops) { refuseToSave(); return; }
  await saveShown(host, name, form, host.id === "near" ? rowsOfNear(stood.near.state, stood.near) : null);
  say(`Saved ${name}.${form}`);
}

const FIGURE = ["csv", "svg", "png"];
const SAVED = { draw: ["drawing", ["svg", "png"]], loops: ["loop", FIGURE], summary: ["figures", ["csv"]], states: ["limit_states", ["csv"]], timepanel: ["history", FIGURE], scales: ["scales", FIGURE],
  curvature: ["moment_curvature", FIGURE], interaction: ["interaction", FIGURE], near: ["nearest_tests", ["csv"]], codes: ["codes", ["csv"]] };

function refuseToSave() {
  note = "Nothing is saved: the input has errors.";
  showMessages();
  say(note);
}

async function openFile(file) {
  if (file.size > 7e6) { note = `${file.name} is too large for a case file.`; showMessages(); return; }
  const answer = await ask("open", { text: await file.text() });
  if (!answer) return;
  if (answer.faults) { note = answer.faults.map(fault => `${file.name}: ${fault.text}`).join("; "); say(note); showMessages(); return; }
  load(answer.state, null, answer.note ?? "");
}

async function openRecord(file) {
  if (file.size > 7e6) { note = `${file.name} is too large for a record.`; showMessages(); return; }
  const answer = await ask("record", { name: file.name, text: await file.text() });
  if (!answer) return;
  if (answer.faults) { showFaults(get("form"), answer.faults); say(answer.faults[0].text); return; }
  state.loading = { ...state.loading, kind: "record", id: answer.id, name: answer.name };
  changed(true);
}

function setUp() {
  for (const [id, [name, forms]] of Object.entries(SAVED)) addSaves(get(id), name, forms, form => savePanel(get(id), name, form).catch(gone));
  for (const id of Object.values(PANELS).flat()) get(id).querySelector("h2").append(element("span", { className: "age" }, "for an earlier input"));
  for (const [key, { label }] of Object.entries(SYSTEMS)) get("units").append(element("option", { value: key }, label));
  get("units").addEventListener("change", () => { system = get("units").value; showAll(); if (!fixed) putLink(); });
  get("code").addEventListener("change", () => { if (fixed) { standReport(); showSections(); } else { showAge(); lanes.sections.go(); } });
  get("scrub").addEventListener("input", () => showPoint());
  get("export").addEventListener("change", event => {
    const form = event.target.value;
    event.target.value = "";
    if (form) save(form).catch(gone);
  });
  get("form").addEventListener("submit", event => event.preventDefault());
  let wait = null;
  window.addEventListener("resize", () => { clearTimeout(wait); wait = setTimeout(() => { showLoops(); showSections(); }, 120); });
  if (fixed) return;
  get("subtitle").after(element("a", { href: "frame.html", className: "other" }, "frames"));
  get("undo").addEventListener("click", () => restore(past.undo()));
  get("redo").addEventListener("click", () => restore(past.redo()));
  document.addEventListener("keydown", event => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.target.matches?.("input[type=text], textarea")) return;
    const key = event.key.toLowerCase();
    if (key === "z") { event.preventDefault(); restore(event.shiftKey ? past.redo() : past.undo()); }
    if (key === "y") { event.preventDefault(); restore(past.redo()); }
  });
  get("open").addEventListener("click", () => get("file").click());
  for (const [id, take] of [["file", openFile], ["recordfile", openRecord]])
    get(id).addEventListener("change", event => { const [file] = event.target.files; event.target.value = ""; if (file) take(file).catch(gone); });
  get("link").addEventListener("click", async () => {
    putLink();
    try { await navigator.clipboard.writeText(location.href); say("The link is copied."); get("link").textContent = "Link copied"; }
    catch { say("The link is in the address."); get("link").textContent = "Link is in the address"; }
    setTimeout(() => { get("link").textContent = "Copy link"; }, 2500);
  });
  window.addEventListener("hashchange", () => {
    const found = unpacked(location.hash.slice(3));
    if (found) load(found.state, found.units);
  });
}

// A report has the answers to its one input.
function standReport() {
  const code = get("code").value;
  for (const [name, found] of Object.entries({ loops: report.loops, sections: report.sections[code], bands: report.bands, scales: report.scales, own: report.own }))
    if (found) stand(name, { columns: found }, { state, code: codeOf(name) });
  if (report.near) stand("near", report.near, { state });
  latest = stood.loops;
}

async function start() {
  setUp();
  if (fixed) {
    document.body.classList.add("report");
    state = report.state;
    standReport();
    get("units").value = system;
    get("subtitle").textContent = report.title;
    for (const id of ["undo", "redo", "open", "link", "drawhint"]) get(id).hidden = true;
    for (const option of [...get("export").options]) if (option.value && !report.exports[option.value]) option.remove();
    showAll();
    return;
  }
  const begin = await (await fetch("start")).json();
  withTests = begin.tests;
  const linked = location.hash.startsWith("#s=") ? unpacked(location.hash.slice(3)) : null;
  state = linked?.state ?? { columns: begin.state.columns, loading: begin.state.loading };
  if (!linked) note = begin.state.note ?? "";
  if (linked?.units && SYSTEMS[linked.units]) system = linked.units;
  get("units").value = system;
  past.begin({ columns: state.columns, loading: state.loading });
  showForm();
  showDrawings();
  showNear();
  askAll();
}

start().catch(gone);
