// What the page shows of the answers: figures and tables.

import { asPng, drawChart, markSign, rowsOfChart, standalone, svgElement } from "./chart.js";
import { element, nameOf } from "./fields.js";
import { shown, unitOf } from "./units.js";

const KINDS = ["a", "b"];
const STATE_NAMES = {
  cracking: ["cracking", "circle", false], first_yield: ["first yield", "circle", true], nominal_moment: ["nominal moment", "diamond", false],
  spalling: ["spalling", "square", false], bar_buckling: ["bar buckling", "triangle", false], hoop_fracture: ["hoop fracture", "square", true],
  bar_fracture: ["bar fracture", "triangle", true], cap: ["cap", "diamond", false], shear_yield: ["yield in shear", "circle", false],
  shear_failure: ["shear failure", "cross", false], strength_loss: ["20 % of strength lost", "diamond", true], collapse: ["collapse", "cross", false],
  axial_failure: ["axial failure", "cross", false],
};
export const nameOfState = name => (STATE_NAMES[name] ?? [name.replaceAll("_", " ")])[0];

const scaled = (values, factor) => values.map(value => value === null ? null : value / factor);

export function loopChart(host, state, loops, bands, system) {
  const [unit, factor] = unitOf(system, "force"), lines = [], marks = [], areas = [], told = [];
  loops.forEach((loop, i) => {
    const drift = scaled(loop.displacement, loop.height / 100), force = scaled(loop.force, factor);
    const name = nameOf(state, i);
    lines.push({ x: drift, y: force, kind: KINDS[i], label: loops.length > 1 ? name : "" });
    const band = bands?.[i];
    if (band?.lower && band.lower.length === drift.length)
      areas.push({ x: drift, lower: scaled(band.lower, factor), upper: scaled(band.upper, factor), kind: KINDS[i] });
    for (const at of loop.states) {
      const [text, shape, filled] = STATE_NAMES[at.name] ?? [at.name, "circle", false];
      marks.push({ x: 100 * at.drift, y: at.force / factor, shape, filled, kind: KINDS[i], title: `${text}, drift ${shown(100 * at.drift, 3)} %` });
    }
    const figures = loop.figures;
    told.push(`column ${name}: largest force ${shown(figures.peak_force / factor)} ${unit}, largest drift ${shown(100 * figures.peak_drift, 3)} %`);
  });
  const one = loops.length === 1 && loops[0], [length, metre] = unitOf(system, "length");
  return drawChart(host, { lines, bands: areas, marks, symmetric: true, zero: true, height: Math.round(Math.max(270, Math.min(0.92 * host.clientWidth, 560))), xLabel: "Drift (%)", yLabel: `Lateral force (${unit})`,
    top: one ? { factor: one.height / 100 / metre, label: `displacement (${length})` } : null, label: "Lateral force against drift; " + told.join("; ") });
}

// Drifts in time: rows of { time, drift, name }.
export function timeChart(host, rows) {
  const known = rows.filter(Boolean), lines = known.map(({ time, drift, name }, i) => ({ x: time, y: scaled(drift, 0.01), kind: KINDS[i] ?? `s${i}`, label: known.length > 1 ? name : "" }));
  return lines.length ? drawChart(host, { lines, zero: true, height: 230, xLabel: "Time (s)", yLabel: "Drift (%)", label: "Drift in time" }) : null;
}

export function scaleChart(host, state, scales) {
  const lines = [], marks = [];
  scales.forEach((found, i) => {
    if (!found?.scales?.length) return;
    const rows = found.scales;
    lines.push({ x: [0, ...rows.map(row => row.scale)], y: [0, ...rows.map(row => 100 * row.drift)], kind: KINDS[i], label: scales.length > 1 ? nameOf(state, i) : "" });
    for (const row of rows) marks.push({ x: row.scale, y: 100 * row.drift, shape: row.status === "completed" ? "circle" : "cross", kind: KINDS[i], title: row.status });
  });
  if (lines.length) drawChart(host, { lines, marks, fromZero: true, height: 230, xLabel: "Scale of the motion", yLabel: "Peak drift (%)", label: "Peak drift against the scale of the motion" });
  else host.replaceChildren();
}

export function curvatureChart(host, state, sections, system) {
  const [unit, factor] = unitOf(system, "moment"), [each, per] = unitOf(system, "curvature"), lines = [], marks = [], faults = [];
  sections.forEach((one, i) => (one?.curvature ?? []).forEach((diagram, confined) => {
    if (diagram.fault) { faults.push(diagram.fault); return; }
    const name = sections.length > 1 ? nameOf(state, i) + ", " : "";
    lines.push({ x: scaled(diagram.curvature, per), y: scaled(diagram.moment, factor), kind: KINDS[i] + (confined ? "" : " thin dashed"), label: name + (confined ? "core confined" : "not confined") });
    if (confined) for (const [event, [x, y]] of Object.entries(diagram.events)) {
      const [label, shape] = { cracking: ["cracking", "circle"], yielding: ["yielding", "square"], peak: ["largest moment", "triangle"], ultimate: ["ultimate", "diamond"] }[event];
      marks.push({ x: x / per, y: y / factor, shape, filled: event !== "cracking", kind: KINDS[i], label: name + label, title: `${label}: ${shown(x / per)} ${each}, ${shown(y / factor)} ${unit}` });
    }
  }));
  if (lines.length) drawChart(host, { lines, marks, fromZero: true, xLabel: `Curvature (${each})`, yLabel: `Moment (${unit})`, label: "Moment against curvature under the axial load", legend: true });
  else host.replaceChildren();
  for (const fault of faults) host.append(element("p", { className: "fault" }, fault));
}

export function interactionChart(host, state, sections, own, loops, system, code) {
  const [unit, factor] = unitOf(system, "moment"), [newton, per] = unitOf(system, "force"), lines = [], marks = [], faults = [];
  sections.forEach((one, i) => {
    const name = sections.length > 1 ? nameOf(state, i) + ", " : "", by = one?.code;
    if (by?.fault) faults.push(by.fault);
    else if (by) {
      lines.push({ x: scaled(by.moment, factor), y: scaled(by.axial_load, per), kind: KINDS[i] + " thin", label: name + "nominal" });
      lines.push({ x: scaled(by.design_moment, factor), y: scaled(by.design_axial_load, per), kind: KINDS[i] + " thin dashed", label: name + "design" });
    }
    for (const [which, kind, label] of [["section", " dotted", "material laws of the section"], ["joint", "", "joint of the model"]]) {
      const found = own?.[i]?.[which];
      if (found?.fault) faults.push(found.fault);
      else if (found) lines.push({ x: scaled(found.moment, factor), y: scaled(found.axial_load, per), kind: KINDS[i] + kind, label: name + label });
    }
    const loop = loops?.[i];
    if (loop?.figures.peak_moment && by) marks.push({ x: loop.figures.peak_moment / factor, y: one.axial_load / per, shape: "circle", filled: true, kind: KINDS[i], label: name + "largest moment of the loop", title: `largest moment of the loop: ${shown(loop.figures.peak_moment / factor)} ${unit}` });
  });
  if (lines.length) drawChart(host, { lines, marks, fromZero: true, xLabel: `Moment (${unit})`, yLabel: `Axial load (${newton})`, legend: true, label: `Interaction of axial load and moment, ${code}; the dot is the largest moment of the loop` });
  else host.replaceChildren();
  for (const fault of faults) host.append(element("p", { className: "fault" }, fault));
}

export function table(heads, rows, caption) {
  const made = element("table", {});
  const count = heads.length - 1 - (rows[0]?.cells.filter((cell, i) => i && cell?.text !== undefined).length ?? 0);
  made.style.setProperty("--numbers", count);
  if (count > 4) made.className = "many";
  if (caption) made.append(element("caption", {}, caption));
  const words = i => rows.every(row => typeof row.cells[i] === "object" && row.cells[i].text !== undefined);
  made.append(element("thead", {}, element("tr", {}, ...heads.map((head, i) => element("th", { scope: "col", className: words(i) ? "text" : "" }, head)))));
  made.append(element("tbody", {}, ...rows.map(row => element("tr", { className: row.kind ?? "" }, ...row.cells.map((cell, i) => {
    const made = element(i ? "td" : "th", { className: typeof cell === "object" && cell.text !== undefined ? "text" : "" }, typeof cell === "object" && cell !== null ? cell.text : cell);
    if (!i) made.setAttribute("scope", "row");
    if (!i && row.sign) made.prepend(row.sign);
    if (cell?.title) made.title = cell.title;
    return made;
  })))));
  return element("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: caption || heads[0] }, made);
}

// ---- what is saved ---------------------------------------------------------------------------------

export function download(name, data, type) {
  const link = element("a", { download: name, href: URL.createObjectURL(data instanceof Blob ? data : new Blob([data], { type })) });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// Figures and tables of a panel: svg or png of each figure, or their numbers as csv.
export async function saveShown(host, name, form, rows = null) {
  const figures = [...host.querySelectorAll("svg:is(.chart, .drawing)")], found = host.querySelector("table");
  if (form === "csv") download(`${name}.csv`, csvOf(rows ?? (found ? rowsOfTable(found) : figures.flatMap(rowsOfChart))), "text/csv");
  else for (const [i, svg] of figures.entries()) {
    const file = `${name}${figures.length > 1 ? "_" + "ab"[i] : ""}.${form}`;
    download(file, form === "svg" ? standalone(svg) : await asPng(svg), "image/svg+xml");
  }
}

export function addSaves(host, name, forms, take) {
  const title = host.querySelector("h2"), what = title.firstChild.textContent;
  title.after(element("div", { className: "saves" }, ...forms.map(form =>
    element("button", { type: "button", ariaLabel: `Save ${what} as ${form}`, title: `Save ${name}.${form}`, onclick: () => take(form) }, form))));
}

const rowsOfTable = made => [...made.rows].map(row => [...row.cells].map(cell => cell.textContent.trim()));

function csvOf(rows) {
  const cell = value => typeof value === "number" ? Number(value.toPrecision(6)) : String(value ?? "").replace(/−(?=\d)/g, "-");
  return rows.map(row => row.map(cell).map(text => /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text).join(",") + "\n").join("");
}

function signOf(name) {
  const [, shape, filled] = STATE_NAMES[name] ?? ["", "circle", false];
  return markSign(shape, filled, "");
}

export function stateTables(host, below, state, loops, bands, system) {
  const [unit, factor] = unitOf(system, "force"), [length, metre] = unitOf(system, "length");
  const names = state.cases.map((_, i) => nameOf(state, i)), two = loops.length > 1;
  const reached = loops.flatMap((loop, i) => (loop?.states ?? []).map(at => ({ ...at, i })));
  const numbers = at => at ? [shown(100 * Math.abs(at.drift), 3), shown(Math.abs(at.displacement) / metre, 3), shown(Math.abs(at.force) / factor, 4)] : ["–", "–", "–"];
  const rows = [...new Set(reached.map(at => at.name))].map(name => {
    const found = loops.map((_, i) => reached.find(at => at.name === name && at.i === i)), first = found.find(Boolean);
    return { sign: signOf(name), cells: [nameOfState(name), ...found.flatMap(numbers), { text: first.source }] };
  });
  const heads = ["First reached", ...loops.flatMap((_, i) => ["drift %", `d ${length}`, `F ${unit}`].map(head => (two ? names[i] + ", " : "") + head)), "criterion"];
  host.replaceChildren(rows.length ? table(heads, rows, "") : element("p", { className: "empty" }, "None is reached."));
  const facts = [];
  const add = (what, key, dimension, digits = 4) => {
    const [u, f] = unitOf(system, dimension);
    facts.push({ cells: [`${what}${u ? ", " + u : ""}`, ...loops.map((loop, i) => {
      const value = loop?.figures?.[key], interval = bands?.[i]?.[key];
      if (value === undefined || value === null) return "–";
      return shown(value / f, digits) + (interval?.[0] != null ? ` (${shown(interval[0] / f, 3)} to ${shown(interval[2] / f, 3)})` : "");
    })] });
  };
  add("largest force", "peak_force", "force");
  add("largest drift", "peak_drift", "drift", 3);
  add("drift at 20 % loss", "drift_at_loss", "drift", 3);
  add("residual drift", "residual_drift", "drift", 3);
  add("work of the springs", "energy", "energy");
  below.replaceChildren(table(["", ...names], facts, bands?.some(band => band?.lower) ? "In brackets: 80 % prediction interval" : ""));
}

const CODE_UNITS = { "N": "force", "N m": "moment", "m": "length", "rad": "drift", "drift": "drift", "1/m": "curvature", "": "number" };

export function codeTable(host, state, sections, system) {
  const lists = sections.map(one => Array.isArray(one?.codes) ? one.codes : []), fault = sections.find(one => one?.codes?.fault)?.codes.fault;
  const names = [...new Set(lists.flat().map(value => value.name))];
  const rows = names.map(name => {
    const found = lists.map(list => list.find(value => value.name === name)), first = found.find(Boolean);
    const [unit, factor] = unitOf(system, CODE_UNITS[first.unit] ?? "number");
    return { cells: [name, ...found.map(value => value ? shown(value.value / factor) : "–"), unit, { text: first.meaning }, { text: first.source + (first.confirmed ? "" : " *") }] };
  });
  const parts = rows.length ? [table(["Value", ...(lists.length > 1 ? state.cases.map((_, i) => nameOf(state, i)) : [""]), "unit", "meaning", "source"], rows, lists.flat().some(value => !value.confirmed) ? "* not confirmed by a second source" : "")] : [];
  if (fault) parts.push(element("p", { className: "fault" }, fault));
  host.replaceChildren(...parts);
}

// A card of a test: its loop grey, the model over it; lines are x, y, x, y, ... in thousandths of their box.
export function testCard(test, system, more = "") {
  const about = `${test.failure}, ${test.section}, n ${shown(test.axial_load_ratio, 2)}, a/h ${shown(test.span_depth_ratio, 2)}`, scores = test.scores;
  const made = element("figure", {}, element("figcaption", {}, element("b", {}, test.name), element("br"), about));
  if (test.test) {
    const width = 260, height = 190, X = x => width / 2 * (1 + 0.92e-3 * x), Y = y => height / 2 * (1 - 0.92e-3 * y);
    const path = line => { let d = ""; for (let i = 0; i < line.length; i += 2) d += (i ? "L" : "M") + X(line[i]).toFixed(1) + " " + Y(line[i + 1]).toFixed(1); return d; };
    const [unit, factor] = unitOf(system, "force"), [length, metre] = unitOf(system, "length");
    const drift = test.height > 0 ? ` = ${shown(100 * test.displacement / test.height, 2)} %` : "";
    made.append(svgElement("svg", { viewBox: `0 0 ${width} ${height}`, class: "card", role: "img", "aria-label": `${test.name}: prediction over test, error ${shown(scores.nrmse, 3)}` },
      svgElement("path", { class: "zero", d: `M0 ${height / 2}H${width}M${width / 2} 0V${height}` }),
      svgElement("path", { class: "line test", d: path(test.test) }), svgElement("path", { class: "line a thin", d: path(test.model) }),
      svgElement("text", { x: width - 2, y: height / 2 + 12, "text-anchor": "end" }, `${shown(test.displacement / metre, 3)} ${length}${drift}`),
      svgElement("text", { x: width / 2 + 4, y: 11 }, `${shown(test.force / factor, 3)} ${unit}`)));
  }
  const words = [["error", "nrmse"], ["peak", "peak_ratio"], ["energy", "energy_ratio"], ["stiffness", "stiffness_ratio"], ["end", "end_ratio"]].map(([word, name]) => `${word} ${shown(scores[name], 3)}`);
  made.append(element("p", {}, [...words, more].filter(Boolean).join(" · ")));
  if (test.status !== "completed") made.append(element("p", { className: "fault" }, `${test.status}: ${test.error}`));
  return made;
}

export function rowsOfNear(state, near) {
  const tests = near.columns.flatMap((column, i) => (column.tests ?? []).map(test => [nameOf(state, i), test]));
  const scores = Object.keys(tests[0]?.[1].scores ?? {});
  return [["column", "test", "distance", "failure", ...scores], ...tests.map(([name, test]) => [name, test.name, test.distance, test.failure, ...scores.map(score => test.scores[score])])];
}

export function nearCards(host, state, near, system) {
  const parts = [];
  near.columns.forEach((column, i) => {
    if (near.columns.length > 1) parts.push(element("h3", {}, `Column ${nameOf(state, i)}`));
    if (column.none) parts.push(element("p", { className: "empty" }, column.none));
    else parts.push(element("div", { className: "cards" }, ...column.tests.map(test => testCard(test, system, `distance ${shown(test.distance, 2)}`))));
  });
  host.replaceChildren(...parts);
}
