// The fields of the form: what a number is called, its dimension, where it stands in the state.

import { barSize, inUnits, parsed, stepOf, typed, unitOf } from "./units.js";

const ROUND = ["circle", "hollow_circle"], BOXED = ["rectangle", "hollow_rectangle"];
const HOLLOW = ["hollow_rectangle", "hollow_circle"];

// path, label, dimension, step of the arrow keys in SI, and for which shapes
export const COLUMN_FIELDS = [
  { group: "Section", fields: [
    { path: "section.shape", label: "Shape", choices: [["rectangle", "rectangle"], ["circle", "circle"], ["hollow_rectangle", "hollow rectangle"], ["hollow_circle", "ring"]] },
    { path: "section.width", label: "Width", dimension: "length", step: 0.01, shapes: BOXED },
    { path: "section.depth", label: "Depth, along the load", dimension: "length", step: 0.01, shapes: BOXED },
    { path: "section.diameter", label: "Diameter", dimension: "length", step: 0.01, shapes: ROUND },
    { path: "section.wall", label: "Wall", dimension: "length", step: 0.01, shapes: HOLLOW },
    { path: "section.cover", label: "Clear cover to hoops", dimension: "length", step: 0.001 },
    { path: "concrete.fc", label: "Concrete strength", dimension: "stress", step: 1e6 },
  ] },
  { group: "Longitudinal bars", fields: [
    { path: "bars.number", label: "Number", dimension: "number", whole: true, step: 1 },
    { path: "bars.face", label: "On the tension face", dimension: "number", whole: true, step: 1, optional: "number/4 + 1", shapes: BOXED },
    { path: "bars.diameter", label: "Diameter", dimension: "length", bar: true },
    { path: "bars.fy", label: "Yield stress", dimension: "stress", step: 1e7 },
    { path: "bars.fu", label: "Ultimate stress", dimension: "stress", step: 1e7, optional: "1.5 × yield" },
  ] },
  { group: "Transverse bars", fields: [
    { path: "ties.hoops", label: "Kind", choices: [[false, "spiral"], [true, "single hoops"]], shapes: ROUND },
    { path: "ties.diameter", label: "Diameter", dimension: "length", bar: true },
    { path: "ties.spacing", label: "Spacing", dimension: "length", step: 0.005 },
    { path: "ties.legs", label: "Legs along the load", dimension: "number", step: 1, optional: "2", shapes: BOXED },
    { path: "ties.legs_across", label: "Legs across", dimension: "number", step: 1, optional: "as along", shapes: BOXED },
    { path: "ties.fy", label: "Yield stress", dimension: "stress", step: 1e7 },
    { path: "ties.fu", label: "Ultimate stress", dimension: "stress", step: 1e7, optional: "1.5 × yield" },
  ] },
  { group: "Column", fields: [
    { path: "column.ends", label: "Ends", choices: [["cantilever", "cantilever"], ["double", "double curvature"]] },
    { path: "column.height", label: "Height", dimension: "length", step: 0.05 },
    { path: "column.axial_load", label: "Axial load, compression +", dimension: "force", step: 1e4 },
    { path: "column.top_mass", label: "Mass at the top", dimension: "mass", step: 1e3, optional: "axial load / g", motion: true },
    { path: "footing.kind", label: "Foot", choices: [["none", "rigid ground"], ["springs", "footing on springs"]] },
    { path: "footing.rotation", label: "Springs against turning", dimension: "turning", step: 1e7, footing: true },
    { path: "footing.sliding", label: "Springs against sliding", dimension: "stiffness", step: 1e7, footing: true },
    { path: "footing.height", label: "Height of the footing", dimension: "length", step: 0.05, footing: true },
    { path: "footing.mass", label: "Mass of the footing", dimension: "mass", step: 1e3, footing: true, motion: true },
  ] },
];

export const LOADING_FIELDS = [
  { path: "loading.kind", label: "Loading", choices: [["amplitudes", "cycles of drift"], ["named", "protocol of the literature"], ["synthetic", "synthetic earthquake"], ["record", "record from a file"]] },
  { path: "loading.amplitudes", label: "Drifts", dimension: "drift", list: true, kinds: ["amplitudes"] },
  { path: "loading.cycles", label: "Cycles at each", dimension: "number", whole: true, step: 1, kinds: ["amplitudes"] },
  { path: "loading.name", label: "Protocol", kinds: ["named"], choices: [["sac", "SAC 1997"], ["aci_374_1", "ACI 374.1"], ["aci_374_2", "ACI 374.2R"], ["fema_461", "FEMA 461"], ["curee", "CUREE"], ["atc_24", "ATC-24"]] },
  { path: "loading.reference", label: "Reference drift", dimension: "drift", step: 0.001, optional: "of the protocol", kinds: ["named"] },
  { path: "loading.largest", label: "Largest drift", dimension: "drift", step: 0.005, optional: "of the protocol", kinds: ["named"] },
  { path: "loading.seed", label: "Number of the earthquake", dimension: "number", whole: true, step: 1, kinds: ["synthetic"] },
  { path: "loading.scale", label: "Times", dimension: "ratio", step: 0.1, kinds: ["synthetic", "record"] },
];

export const LOADINGS = {
  amplitudes: { kind: "amplitudes", amplitudes: [0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06], cycles: 2 },
  named: { kind: "named", name: "aci_374_1", largest: 0.06 },
  synthetic: { kind: "synthetic", seed: 1, scale: 1 },
  record: { kind: "record", id: "", name: "", scale: 1 },
};

export function valueAt(object, path) {
  return path.split(".").reduce((part, name) => (part ?? {})[name], object);
}

export function putAt(object, path, value) {
  const names = path.split("."), last = names.pop();
  let part = object;
  for (const name of names) part = part[name] ??= {};
  if (value === null) delete part[last];
  else part[last] = value;
}

export function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const FIELD = Object.fromEntries([...COLUMN_FIELDS.flatMap(({ fields }) => fields), ...LOADING_FIELDS].map(field => [field.path, field]));

export const toldOf = (fault, state, column, system) => toldAs(fault, FIELD[fault.field], valueAt(fault.field.startsWith("loading.") ? state : column, fault.field), system);

// A message of the program as the page says it: with the label and the unit of its field; an empty field says what it lacks.
export function toldAs(fault, field, value, system) {
  if (!field) return inUnits(fault.text, system);
  const name = field.path.split(".").at(-1);
  const label = field.label.split(",")[0], [unit] = field.dimension ? unitOf(system, field.dimension) : [""];
  if (!field.optional && !field.choices && (value === undefined || value === null || value.length === 0))
    return `${label}: give ${field.whole ? "a whole number" : unit ? `a value in ${unit}` : "a number"}`;
  return inUnits(fault.text, system, field.dimension).replace(new RegExp(`^(?:[a-z ]+: )?${name} = `), `${label} = `);
}

function shownValue(field, value, system) {
  const [, factor] = field.dimension ? unitOf(system, field.dimension) : ["", 1];
  if (field.list) return Array.isArray(value) ? value.map(v => typed(v, factor)).join(", ") : String(value ?? "");
  return typed(value, factor);
}

function readValue(field, text, system) {
  const [, factor] = unitOf(system, field.dimension);
  if (field.list) {
    const words = text.split(/[\s;,]+/).filter(Boolean);
    return words.map(word => parsed(word, factor)).filter(value => value !== null);
  }
  return parsed(text, factor, field.whole);
}

const idOf = path => "f-" + path.replaceAll(".", "-");

// One labelled field with its message; `edit(value, done)` is called while one types and when it is left.
export function fieldRow(field, value, system, edit, fixed) {
  const id = idOf(field.path), message = id + "-fault";
  const row = element("div", { className: "row" });
  row.dataset.path = field.path;
  const [unit] = field.dimension ? unitOf(system, field.dimension) : [""];
  row.append(element("label", { htmlFor: id }, field.label));
  let input;
  if (field.choices) {
    input = element("select", { id, disabled: fixed });
    for (const [key, text] of field.choices) input.append(element("option", { value: String(key), selected: key === (value ?? field.choices[0][0]) }, text));
    input.addEventListener("change", () => edit(field.choices.find(([key]) => String(key) === input.value)[0], true));
  } else {
    const given = { id, value: shownValue(field, value, system), readOnly: fixed, spellcheck: false };
    input = field.list ? element("textarea", { ...given, rows: 2 }) : element("input", { ...given, type: "text", inputMode: "decimal" });
    input.placeholder = field.optional ?? "needed";
    input.addEventListener("input", () => edit(readValue(field, input.value, system), false));
    input.addEventListener("change", () => edit(readValue(field, input.value, system), true));
    input.addEventListener("keydown", event => {
      const way = { ArrowUp: 1, ArrowDown: -1, PageUp: 5, PageDown: -5 }[event.key];
      const now = readValue(field, input.value, system);
      if (!way || fixed || !(field.step || field.bar) || typeof now !== "number") return;
      event.preventDefault();
      const step = field.bar ? 0 : stepOf(system, field.dimension, field.step);
      const next = field.bar ? barSize(system, now, way) : Math.round((now + way * step) / step * 1e6) / 1e6 * step;
      input.value = shownValue(field, Number(next.toPrecision(10)), system);
      edit(readValue(field, input.value, system), false);
    });
  }
  input.setAttribute("aria-describedby", message);
  const box = element("span", { className: "value" }, input);
  if (unit) {
    box.append(element("span", { className: "unit", id: id + "-unit" }, unit));
    input.setAttribute("aria-describedby", `${message} ${id}-unit`);
  }
  row.append(box, element("p", { className: "fault", id: message, hidden: true }));
  return row;
}

// Fields under a title; none without fields.
export function fieldGroup(title, rows) {
  return rows.length ? [element("fieldset", {}, element("legend", {}, title), ...rows)] : [];
}

// The fields of a loading, with the button that opens a record.
export function loadingRows(loading, system, edit, fixed, fields = LOADING_FIELDS) {
  const rows = fields
    .filter(field => !field.kinds || field.kinds.includes(loading.kind))
    .map(field => fieldRow(field, valueAt({ loading }, field.path), system, (value, done) => edit(field.path, value, done), fixed));
  if (loading.kind === "record") {
    const button = element("button", { type: "button", disabled: fixed, id: "f-loading-record" }, loading.name || "Open a record…");
    button.addEventListener("click", () => document.getElementById("recordfile").click());
    button.setAttribute("aria-describedby", "f-loading-record-fault f-loading-record-hint");
    const row = element("div", { className: "row" }, element("span", {}, "Record"), button, element("p", { className: "fault", id: "f-loading-record-fault", hidden: true }),
      element("p", { className: "hint", id: "f-loading-record-hint" }, "A file .at2 of the PEER database, or .csv or .txt whose first line names the columns with their units, as time_s, acceleration_g (or m/s2, cm/s2)."));
    row.dataset.path = "loading.record";
    rows.splice(1, 0, row);
  }
  return rows;
}

// The form of a column and the loading. `edit(path, value, done)`.
export function drawForm(form, state, active, system, edit, fixed = false) {
  const column = state.columns[active], parts = [];
  const motion = ["synthetic", "record"].includes(state.loading.kind);
  if ("case" in column) {
    const text = element("textarea", { id: "f-case", value: column.case, rows: 14, spellcheck: false, readOnly: fixed });
    text.setAttribute("aria-describedby", "f-case-fault");
    text.addEventListener("input", () => edit("case", text.value, false));
    text.addEventListener("change", () => edit("case", text.value, true));
    const row = element("div", { className: "row wide" }, element("label", { htmlFor: "f-case" }, "Case file"), text, element("p", { className: "fault", id: "f-case-fault", hidden: true }));
    row.dataset.path = "case";
    parts.push(...fieldGroup("Column and loading of a case file", [row]));
  } else {
    const shape = valueAt(column, "section.shape"), footing = valueAt(column, "footing.kind") === "springs";
    for (const { group, fields } of COLUMN_FIELDS) {
      parts.push(...fieldGroup(group, fields
        .filter(field => (!field.shapes || field.shapes.includes(shape)) && (!field.motion || motion) && (!field.footing || footing))
        .map(field => fieldRow(field, valueAt(column, field.path), system, (value, done) => edit(field.path, value, done), fixed))));
    }
  }
  if (!state.columns.every(one => "case" in one))
    parts.push(...fieldGroup(state.columns.length > 1 ? "Loading of both columns" : "Loading", loadingRows(state.loading, system, edit, fixed)));
  form.replaceChildren(...parts);
}

// Put the messages beside their fields; what has no field is returned.
export function showFaults(form, faults) {
  const left = [];
  for (const row of form.querySelectorAll(".row")) {
    const mine = faults.filter(fault => fault.field === row.dataset.path);
    const place = row.querySelector(".fault"), input = row.querySelector("input, select, textarea, button");
    const text = [...new Set(mine.map(fault => fault.text))].join("\n");
    if (place.textContent !== text) place.textContent = text;
    place.hidden = !text;
    if (text) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
  }
  const shown = new Set([...form.querySelectorAll(".row")].map(row => row.dataset.path));
  for (const fault of faults) if (!shown.has(fault.field)) left.push(fault.text);
  return left;
}

// The values of fields anew, except of the one that is being typed in.
export function refreshFields(form, fields, valueOf, system) {
  for (const field of fields) {
    const input = form.querySelector(`[id="${idOf(field.path)}"]`);
    if (!input || input === document.activeElement) continue;
    const value = valueOf(field.path);
    if (field.choices) input.value = String(value ?? field.choices[0][0]);
    else input.value = shownValue(field, value, system);
  }
}
