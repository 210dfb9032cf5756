// The page: one state, what it shows of it, and what it asks.

import { SYSTEMS, shown, unitOf } from "./units.js";
import { standalone, asPng } from "./chart.js";
import { drawColumn, scalesOf } from "./drawing.js";
import { LOADINGS, drawForm, element, putAt, refreshFields, showFaults } from "./fields.js";
import { codeTable, curvatureChart, interactionChart, loopChart, nameOfState, nearCards, scaleChart, stateTables, timeChart } from "./panels.js";
import { makeHistory, packed, unpacked } from "./history.js";
import { ask, makeLane } from "./answers.js";

const get = id => document.getElementById(id);
const inside = get("report");
const report = inside ? JSON.parse(inside.textContent) : null;
const fixed = report !== null;
let state = null, active = 0, system = "mm", withTests = false, note = "";
let loops = [], bands = null, scales = null, sections = [], own = null, near = null, scalesDrawn = [], chart = null, dragging = false;

const isMotion = () => loops.some(loop => loop?.dynamic) || (["synthetic", "record"].includes(state.loading.kind) && state.columns.some(one => !("case" in one)));
const sent = () => ({ state: { columns: state.columns, loading: state.loading } });

function say(text) {
  if (get("live").textContent !== text) get("live").textContent = text;
}

// ---- what is asked ---------------------------------------------------------------------------------

function gone(error) {
  get("loopstate").textContent = error instanceof TypeError ? "No answer: the server has ended. Start rbsdem explore again." : error.message;
  get("loopstate").classList.add("fault");
}

const lanes = fixed ? {} : {
  loops: makeLane("loops", { question: sent, take: takeLoops, fail: gone, keep: true }),
  sections: makeLane("sections", { question: () => ({ ...sent(), code: get("code").value }), take: answer => { sections = answer.columns; showSections(); }, fail: gone, delay: 60 }),
  bands: makeLane("bands", { question: () => isMotion() ? null : sent(), take: answer => { bands = answer.columns; showLoops(); }, fail: gone, delay: 140 }),
  scales: makeLane("scales", { question: () => isMotion() ? sent() : null, take: answer => { scales = answer.columns; showTime(); }, fail: gone, delay: 300 }),
  own: makeLane("own", { question: sent, take: answer => { own = answer.columns; showSections(); }, fail: gone, delay: 450 }),
  nearest: makeLane("nearest", { question: () => withTests ? sent() : null, take: answer => { near = answer; showNear(); }, fail: gone, delay: 250 }),
};

function askAll() {
  bands = null;
  scales = null;
  own = null;
  lanes.loops.go();
  for (const name of ["sections", "bands", "scales", "own", "nearest"]) lanes[name].go();
}

function takeLoops(answer, body) {
  get("loopstate").classList.remove("fault");
  const now = body.state.columns.length === state.columns.length;
  if (!now) return;
  answer.columns.forEach((loop, i) => {
    // What is refused leaves the last loop, marked as old.
    const before = loops[i];
    loops[i] = loop.displacement || !before?.displacement ? loop : { ...before, faults: loop.faults, notes: loop.notes, figure: loop.figure, stale: true };
  });
  loops.length = state.columns.length;
  showLoops();
  showDrawings();
  showMessages();
}

// ---- what is shown ---------------------------------------------------------------------------------

function showLoops() {
  chart = loopChart(get("loopfigure"), state, loops, bands, system);
  stateTables(get("statetable"), get("figures"), state, loops, bands, system);
  const words = [];
  loops.forEach((loop, i) => {
    if (!loop?.displacement) return;
    const name = loops.length > 1 ? `${state.columns[i].name}: ` : "";
    const seconds = loop.seconds ? ` in ${Math.max(1, Math.round(1e3 * loop.seconds))} ms` : "";
    words.push(name + (loop.stale ? "the last loop that was possible" : `${loop.model ? loop.model + ", " : ""}${loop.displacement.length} points${seconds}`));
  });
  if (!isMotion() && words.length) {
    const found = bands?.filter(band => band.lower) ?? [];
    if (found.length) words.push("shaded: the band of 80 % of left-out tests");
    else if (bands) words.push(bands[0].none ?? "");
    else if (!fixed && loops.some(loop => loop?.displacement && !loop.stale)) words.push("the band follows");
  }
  get("loopstate").textContent = words.filter(Boolean).join(" · ");
  const first = loops.find(loop => loop?.displacement);
  const scrub = get("scrub");
  scrub.disabled = !first;
  scrub.max = first ? first.displacement.length - 1 : 1;
  if (first) showPoint(Number(scrub.value) > 0);
  showTime();
}

function showPoint(visible = true) {
  const i = Math.max(0, loops.findIndex(loop => loop?.displacement)), loop = loops[i];
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
  timeChart(get("timefigure"), state, loops);
  const found = (scales ?? []).filter(one => one.scales);
  scaleChart(get("scalefigure"), state, scales ?? []);
  get("scales").hidden = state.columns.every(one => "case" in one);
  get("scalestate").textContent = found.length ? "Crosses: collapse or axial failure" : "Other scales of the motion follow";
}

function showSections() {
  curvatureChart(get("curvaturefigure"), state, sections, system);
  interactionChart(get("interactionfigure"), state, sections, own, loops, system, get("code").selectedOptions[0].textContent);
  codeTable(get("codetable"), state, sections, system);
  for (const name of ["curvature", "interaction", "codes"]) get(name).hidden = state.columns.every(one => "case" in one);
}

function showNear() {
  get("near").hidden = !near?.columns;
  if (!near?.columns) return;
  get("nearstate").textContent = `Of ${near.tests} tests; grey: test, line: prediction`;
  nearCards(get("neartests"), state, near, system);
}

function showDrawings() {
  const host = get("drawings");
  get("draw").hidden = state.columns.every(one => "case" in one);
  const focused = document.activeElement?.dataset?.path && host.contains(document.activeElement) ? [document.activeElement.closest("[data-column]").dataset.column, document.activeElement.dataset.path] : null;
  while (host.children.length > state.columns.length) host.lastChild.remove();
  state.columns.forEach((column, i) => {
    let box = host.children[i];
    if (!box) { box = element("div", { className: "drawbox" }); box.dataset.column = i; host.append(box); }
    if ("case" in column) { box.replaceChildren(element("p", { className: "empty" }, `Column ${column.name} is a case file: its springs have no drawing.`)); return; }
    if (!dragging) scalesDrawn[i] = scalesOf(column);
    drawColumn(box, column, loops[i]?.figure, { system, scales: scalesDrawn[i] ?? scalesOf(column), kind: "ab"[i], title: column.name, fixed, stale: Boolean(loops[i]?.faults?.length),
      move: (path, value, done) => { choose(i); edit(path, value, done, true); }, moved: (path, begins = false) => { dragging = begins; if (!begins) showDrawings(); } });
  });
  if (focused) host.querySelector(`[data-column="${focused[0]}"] [data-path="${focused[1]}"]`)?.focus();
}

function showMessages() {
  const all = loops.flatMap((loop, i) => (loop?.faults ?? []).map(fault => ({ ...fault, column: i })));
  const left = showFaults(get("form"), all.filter(fault => fault.column === active));
  const lines = [];
  for (const text of left) lines.push(element("p", { className: "fault" }, text));
  for (const fault of all.filter(one => one.column !== active && !one.field.startsWith("loading."))) lines.push(element("p", { className: "fault" }, `Column ${state.columns[fault.column].name}: ${fault.text}`));
  loops.forEach((loop, i) => {
    const name = loops.length > 1 ? `Column ${state.columns[i].name}: ` : "";
    if (loop?.stopped) lines.push(element("p", { className: "note" }, name + loop.stopped));
    if (loop?.status === "axial_failure" && !loop.stale) lines.push(element("p", { className: "note" }, name + "the axial load is lost at the end of the loop"));
    for (const text of loop?.notes ?? []) lines.push(element("p", { className: "note" }, name + text));
  });
  if (note) lines.push(element("p", { className: "note" }, note));
  get("notes").replaceChildren(...lines);
  if (all.length) say(all.map(fault => fault.text).join("; "));
  else {
    const last = loops.flatMap(loop => loop?.states ?? []).map(at => `${nameOfState(at.name)} at ${shown(100 * Math.abs(at.drift), 2)} %`);
    if (!dragging && loops[0]?.figures) say(`Largest force ${shown(loops[0].figures.peak_force / unitOf(system, "force")[1])} ${unitOf(system, "force")[0]}. ${last.join(", ")}`);
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
    if (state.columns.length > 1) { state.columns.pop(); loops.length = 1; active = 0; }
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
  loops.length = Math.min(loops.length, state.columns.length);
  changed(false);
  putLink();
}

function load(found, units, words = "") {
  state = found;
  active = 0;
  loops = [];
  sections = [];
  note = words;
  if (units && SYSTEMS[units]) system = units;
  get("units").value = system;
  changed(true);
}

function download(name, data, type) {
  const link = element("a", { download: name, href: URL.createObjectURL(data instanceof Blob ? data : new Blob([data], { type })) });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function save(form) {
  const svg = get("loopfigure").querySelector("svg");
  if (form === "svg" || form === "png") {
    if (!svg) { say("There is no figure."); return; }
    if (form === "svg") download("loops.svg", standalone(svg), "image/svg+xml");
    else download("loops.png", await asPng(svg));
    say(`Saved loops.${form}`);
    return;
  }
  const answer = fixed ? report.exports[form] : await ask("export", { ...sent(), form, column: active });
  if (!answer?.text) { say("Nothing is saved: the input has errors."); note = "Nothing is saved: the input has errors."; showMessages(); return; }
  const ending = { namelist: "nml", python: "py", csv: "csv" }[form];
  download(`${answer.name}.${ending}`, answer.text, "text/plain");
  say(`Saved ${answer.name}.${ending}`);
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
  for (const [key, { label }] of Object.entries(SYSTEMS)) get("units").append(element("option", { value: key }, label));
  get("units").addEventListener("change", () => { system = get("units").value; showAll(); if (!fixed) putLink(); });
  get("code").addEventListener("change", () => { if (fixed) { sections = report.sections[get("code").value]; showSections(); } else lanes.sections.go(); });
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

async function start() {
  setUp();
  if (fixed) {
    document.body.classList.add("report");
    ({ state, loops, bands, scales, own, near } = report);
    sections = report.sections[get("code").value];
    get("units").value = system;
    get("subtitle").textContent = report.title;
    for (const id of ["undo", "redo", "open", "link", "drawhint"]) get(id).hidden = true;
    for (const option of [...get("export").options]) if (option.value && !["svg", "png"].includes(option.value) && !report.exports[option.value]) option.remove();
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
  near = null;
  past.begin({ columns: state.columns, loading: state.loading });
  showForm();
  showDrawings();
  showNear();
  askAll();
}

start().catch(gone);
