// The state machine of the page: an input, the answers that stand, undo, link, open and save. A view draws one kind of input.

import { SYSTEMS } from "./units.js";
import { element, groupOf, isText, putLoading } from "./fields.js";
import { addSaves, download, saveShown } from "./panels.js";
import { makeHistory, packed, unpacked } from "./history.js";
import { ask, makeLane } from "./answers.js";

export const get = id => document.getElementById(id);
export const copied = value => JSON.parse(JSON.stringify(value));
const inside = get("report");
export const report = inside ? JSON.parse(inside.textContent) : null;
export const fixed = report !== null;
// What all views share. Each view has a state, its history, the answers that stand, and the newest answer, whose input may be refused.
export const page = { view: null, views: {}, system: "mm", note: "", defect: "", dragging: false };

export const keyOf = state => JSON.stringify(state);
export const sent = () => ({ state: copied(page.view.state) });
const codeOf = (view, name) => view.codeOf?.(name);
export const isOld = (name, view = page.view) => Boolean(view.stood[name]) && (view.stood[name].key !== keyOf(view.state) || view.stood[name].code !== codeOf(view, name));
// An answer that belongs to the loops that stand.
export const beside = (name, view = page.view) => view.stood[name]?.key === view.stood.loops?.key ? view.stood[name] ?? null : null;

// For readers of screens; the empty text takes back what was said.
export function say(text) {
  if (get("live").textContent !== text) get("live").textContent = text;
}

// ---- what is asked ---------------------------------------------------------------------------------

export function gone(error) {
  page.defect = error instanceof TypeError ? "No answer: the server has ended. Start rbsdem explore again." : error.message;
  page.view.showStatus();
}

export function stand(view, name, answer, { state: of, code }) {
  view.stood[name] = { ...answer, state: of, key: keyOf(of), code };
  showAge();
}

// A view with its lanes: the loops, and those that are asked of the input that was accepted.
// `slow` are rows of lane, name of its answer, delay, what is shown then, whether it is asked, and more of the question.
export function addView(view, slow) {
  Object.assign(view, { state: null, stood: {}, latest: null, past: makeHistory(() => view === page.view && showHistory()) });
  page.views[view.name] = view;
  if (fixed) return;
  view.lanes = { loops: makeLane("loops", { question: () => ({ state: copied(view.state) }), take: (answer, body) => takeLoops(view, answer, body), fail: gone, keep: true }) };
  for (const { lane, name = lane, delay, show, asks = () => true, more = () => ({}) } of slow) {
    view.lanes[lane] = makeLane(lane, {
      question: () => view.stood.loops && asks() ? { state: view.stood.loops.state, ...more() } : null,
      take: (answer, body) => { stand(view, name, answer, body); if (view === page.view) show(); },
      fail: gone, delay,
    });
    view.lanes[lane].answers = name;
  }
}

function takeLoops(view, answer, body) {
  page.defect = "";
  view.latest = { ...answer, state: body.state, key: keyOf(body.state) };
  const shows = view === page.view;
  // An input that is refused leaves all as it was: what stands belongs to one input.
  if (view.accepts(answer)) {
    stand(view, "loops", answer, body);
    if (shows) view.showLoops();
    for (const lane of Object.values(view.lanes)) {
      const { answers: name } = lane;
      if (!name) continue;
      if (view.stood[name]?.key !== view.stood.loops.key || view.stood[name].code !== codeOf(view, name)) lane.go();
      else lane.stop();
    }
  }
  if (!shows) return;
  showAge();
  view.showStatus();
  view.showDrawings();
  view.showMessages();
}

export function askAll() {
  page.view.lanes.loops.go();
  showAge();
}

// Marks what belongs to an earlier input.
export function showAge() {
  for (const [name, panels] of Object.entries(page.view.panels)) for (const id of panels) get(id).classList.toggle("old", isOld(name));
}

export function showStatus(words) {
  const { latest, stood, state } = page.view, refused = latest && latest.key === keyOf(state) && latest.key !== stood.loops?.key;
  const text = refused ? (stood.loops ? "The input is refused; the results shown belong to the last valid input" : "") : words.filter(Boolean).join(" · ");
  get("loopstate").textContent = page.defect || text;
  get("loopstate").classList.toggle("fault", Boolean(page.defect));
}

// Messages beneath the figure: faults without a field, then notes.
export function showNotes(faults, notes) {
  const line = className => text => element("p", { className }, text);
  get("notes").replaceChildren(...faults.map(line("fault")), ...[...notes, page.note].filter(Boolean).map(line("note")));
}

// ---- what is done ----------------------------------------------------------------------------------

export function edit(path, value, done, redraw = false) {
  const { view } = page;
  view.put(path, value);
  page.note = "";
  if (view.complete(path, done)) { changed(true); return; }
  if (redraw) view.refresh();
  view.showDrawings();
  askAll();
  if (done) keep();
}

function keep() {
  if (page.view.past.commit(page.view.state)) putLink();
}

// The input stays in the address, as a link; that of each view stays in the tab.
function putLink() {
  const link = "#s=" + packed({ state: page.view.state, units: page.system });
  window.history.replaceState(null, "", link);
  try { sessionStorage.setItem(page.view.name, link); } catch { /* A browser may keep nothing. */ }
}

function kept(name) {
  try { return unpacked(sessionStorage.getItem(name)?.slice(3) ?? ""); } catch { return null; }
}

// After a change of what there is, not only of a number.
export function changed(commit) {
  if (!fixed) askAll();
  page.view.showForm();
  page.view.showDrawings();
  if (commit) keep();
}

function showHistory() {
  const { back, forth } = page.view.past.ways();
  get("undo").disabled = !back;
  get("redo").disabled = !forth;
}

function restore(found) {
  if (!found) return;
  page.view.state = found;
  page.view.settle();
  changed(false);
  putLink();
}

// The view of a state: of columns, or of a frame.
const viewOf = ({ cases: [one] }) => page.views[!isText(one) && groupOf(one, "frame") ? "frame" : "columns"];

function load(found, units) {
  const view = viewOf(found);
  view.state = found;
  view.settle();
  page.note = "";
  if (units && SYSTEMS[units]) page.system = units;
  get("units").value = page.system;
  if (view === page.view) changed(true);
  else look(view);
}

// Show a view; what is on it stays where one goes to the other and back.
export function look(view) {
  page.view = view;
  page.defect = "";
  for (const name of Object.keys(page.views)) document.body.classList.toggle(`view-${name}`, name === view.name);
  for (const panel of document.querySelectorAll("[data-view]")) panel.hidden = panel.dataset.view !== view.name;
  for (const tab of get("views").children) tab.setAttribute("aria-pressed", String(tab.dataset.name === view.name));
  for (const [id, title] of Object.entries(view.titles)) get(id).querySelector("h2").firstChild.textContent = title;
  get(view.scrubs).append(get("scrubbox"));
  view.begin();
  showHistory();
  keep();
  putLink();
  view.showAll();
  if (view.stood.loops?.key !== keyOf(view.state)) askAll();
  showAge();
}

function refuseToSave() {
  page.note = "Nothing is saved: the input has errors.";
  page.view.showMessages();
  say(page.note);
}

async function save(form) {
  const answer = fixed ? report.exports[form] : await ask(form === "report" ? "report" : "export", { ...sent(), form, units: page.system, ...page.view.exported?.() });
  if (!answer?.text) { refuseToSave(); return; }
  const ending = { namelist: "nml", csv: "csv", report: "html" }[form];
  download(`${answer.name}.${ending}`, answer.text, "text/plain");
  say(`Saved ${answer.name}.${ending}`);
}

// What a panel shows, if it belongs to the present input.
async function savePanel(host, name, form) {
  const { view } = page, [panel] = Object.entries(view.panels).find(([, ids]) => ids.includes(host.closest("section").id)) ?? ["loops"];
  if (isOld(panel) || !view.stood.loops) { refuseToSave(); return; }
  await saveShown(host, name, form, view.rowsOf?.(host.id));
  say(`Saved ${name}.${form}`);
}

async function openFile(file) {
  if (file.size > 7e6) { page.note = `${file.name} is too large for a case file.`; page.view.showMessages(); return; }
  const answer = await ask("open", { text: await file.text() });
  if (!answer) return;
  if (answer.faults) { page.note = answer.faults.map(fault => `${file.name}: ${fault.text}`).join("; "); page.view.showMessages(); say(page.note); return; }
  load(answer.state, null);
}

async function openRecord(file) {
  if (file.size > 7e6) { page.note = `${file.name} is too large for a record.`; page.view.showMessages(); return; }
  const answer = await ask("record", { name: file.name, text: await file.text() });
  if (!answer) return;
  if (answer.faults) { page.note = answer.faults[0].text; page.view.showMessages(); say(page.note); return; }
  for (const one of page.view.state.cases) if (!isText(one)) putLoading(one, get("recordfile").dataset.key, answer.file);
  changed(true);
}

const FIGURE = ["csv", "svg", "png"];
const SAVED = { building: ["frame", ["svg", "png"]], draw: ["drawing", ["svg", "png"]], loops: ["loop", FIGURE], summary: ["figures", ["csv"]], storeys: ["storeys", ["csv"]], states: ["limit_states", ["csv"]], members: ["members", ["csv"]],
  timepanel: ["history", FIGURE], scales: ["scales", FIGURE], curvature: ["moment_curvature", FIGURE], interaction: ["interaction", FIGURE], near: ["nearest_tests", ["csv"]], codes: ["codes", ["csv"]] };

export function setUp() {
  for (const [id, [name, forms]] of Object.entries(SAVED)) addSaves(get(id), name, forms, form => savePanel(get(id), name, form).catch(gone));
  for (const panel of document.querySelectorAll("main > section:not(#inputs)")) panel.querySelector("h2").append(element("span", { className: "age" }, "for an earlier input"));
  for (const [key, { label }] of Object.entries(SYSTEMS)) get("units").append(element("option", { value: key }, label));
  get("units").addEventListener("change", () => { page.system = get("units").value; page.view.showAll(); if (!fixed) putLink(); });
  get("scrub").addEventListener("input", () => page.view.showPoint());
  get("export").addEventListener("change", event => {
    const form = event.target.value;
    event.target.value = "";
    if (form) save(form).catch(gone);
  });
  get("form").addEventListener("submit", event => event.preventDefault());
  let wait = null;
  window.addEventListener("resize", () => { clearTimeout(wait); wait = setTimeout(() => page.view.resized(), 120); });
  if (fixed) return;
  for (const view of Object.values(page.views)) {
    const tab = element("button", { type: "button", className: "tab a", onclick: () => look(view) }, view.label);
    tab.dataset.name = view.name;
    get("views").append(tab);
  }
  get("undo").addEventListener("click", () => restore(page.view.past.undo()));
  get("redo").addEventListener("click", () => restore(page.view.past.redo()));
  document.addEventListener("keydown", event => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.target.matches?.("input[type=text], textarea")) return;
    const key = event.key.toLowerCase();
    if (key === "z") { event.preventDefault(); restore(event.shiftKey ? page.view.past.redo() : page.view.past.undo()); }
    if (key === "y") { event.preventDefault(); restore(page.view.past.redo()); }
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

export async function start() {
  const begin = await (await fetch("start")).json();
  page.withTests = begin.tests;
  const linked = unpacked(location.hash.slice(3));
  const own = linked?.state ?? begin.state ?? begin.columns, first = viewOf(own);
  for (const view of Object.values(page.views)) {
    view.state = kept(view.name)?.state ?? begin[view.name];
    if (view === first) view.state = { cases: own.cases };
    view.past.begin(view.state);
  }
  if (linked?.units && SYSTEMS[linked.units]) page.system = linked.units;
  get("units").value = page.system;
  look(first);
}
