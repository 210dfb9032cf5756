// The fields of the form: what a number is called, its dimension, which key of a case it is.

import { barSize, inUnits, parsed, stepOf, typed, unitOf } from "./units.js";

// A case is the list of the groups of a case file, [name, {key: value}], or the text of one. A path is "group.key", of the first
// such group of a list, "steel@layout.fy", of the steel that the layout names, or "3.key", of the group at that place.

export const groupOf = (groups, name) => {
  const [what, owner] = name.split("@"), id = owner && groupOf(groups, owner)?.[1].steel;
  return groups.find(([own, values]) => own === what && (!owner || id === undefined || values.id === id));
};
export const valuesOf = (groups, name) => groupOf(groups, name)?.[1];
export const isText = one => typeof one === "string";
export const nameOf = (state, i) => (!isText(state.cases[i]) && valuesOf(state.cases[i], "case")?.title) || "AB"[i];

const parts = path => { const at = path.lastIndexOf("."); return [path.slice(0, at), path.slice(at + 1)]; };
const find = (groups, name) => /^\d+$/.test(name) ? groups[Number(name)] : groupOf(groups, name);

export function valueAt(groups, path) {
  const [name, key] = parts(path);
  return find(groups, name)?.[1][key];
}

// Put a value where its path says; a group that is not there is added behind the others of `own`.
export function putAt(groups, path, value, own = groups) {
  const [name, key] = parts(path);
  let found = find(/^\d+$/.test(name) ? groups : own, name);
  if (!found) {
    if (value === null) return;
    found = [name.split("@")[0], {}];
    groups.splice(groups.indexOf(own.at(-1)) + 1, 0, found);
  }
  if (value === null) delete found[1][key];
  else found[1][key] = value;
  if (!Object.keys(found[1]).length && OPTIONAL.includes(found[0])) groups.splice(groups.indexOf(found), 1);
}

// Groups that are there only with a value.
const OPTIONAL = ["lap", "damping"];

// The path of a value by the place of its group, as messages have it.
export function placeOf(groups, path, own = groups) {
  const [name, key] = parts(path), found = find(/^\d+$/.test(name) ? groups : own, name);
  return found ? `${groups.indexOf(found)}.${key}` : path;
}

// Path by names of a path by places.
function namedPath(groups, path) {
  const [name, key] = parts(path);
  return /^\d+$/.test(name) ? `${groups[Number(name)]?.[0]}.${key}` : `${name.split("@")[0]}.${key}`;
}

// The groups of each drawing, from its own on.
const OF_DRAWING = ["section", "concrete", "steel", "bars", "row", "layout", "inner_layout", "ties", "spiral", "boundary", "curtain", "lap", "parameter"];
export function drawingsOf(groups) {
  const found = [];
  for (const one of groups) {
    if (one[0] === "drawing") found.push([one]);
    else if (found.length && OF_DRAWING.includes(one[0])) found.at(-1).push(one);
  }
  return found;
}

export const LOADING_FIELDS = [
  { path: "loading.kind", label: "Loading", choices: [["amplitudes", "cycles of drift"], ["named", "protocol of the literature"], ["synthetic", "synthetic earthquake"], ["record", "record from a file"]] },
  { path: "loading.values", label: "Roof displacement of the push", dimension: "length", list: true, kinds: ["push"] },
  { path: "loading.amplitudes", label: "Drifts", dimension: "drift", list: true, kinds: ["amplitudes"] },
  { path: "loading.cycles", label: "Cycles at each", dimension: "number", whole: true, list: true, kinds: ["amplitudes"] },
  { path: "loading.protocol", label: "Protocol", kinds: ["named"], choices: [["sac", "SAC 1997"], ["aci_374_1", "ACI 374.1"], ["aci_374_2", "ACI 374.2R"], ["fema_461", "FEMA 461"], ["curee", "CUREE"], ["atc_24", "ATC-24"]] },
  { path: "loading.reference", label: "Reference drift", dimension: "drift", step: 0.001, optional: "of the protocol", kinds: ["named"] },
  { path: "loading.largest", label: "Largest drift", dimension: "drift", step: 0.005, optional: "of the protocol", kinds: ["named"] },
  { path: "loading.seed", label: "Number of the earthquake", dimension: "number", whole: true, step: 1, kinds: ["synthetic"] },
  { path: "loading.scale", label: "Times", dimension: "ratio", step: 0.1, kinds: ["synthetic", "record"] },
];

const CYCLIC = { drive: "displacement", unit: "drift" }, GROUND = { drive: "ground_acceleration", scale: 1 };
const LOADINGS = {
  push: { drive: "displacement", values: [0.288] },
  amplitudes: { ...CYCLIC, amplitudes: [0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06], cycles: [2] },
  named: { ...CYCLIC, protocol: "aci_374_1", largest: 0.06 },
  synthetic: { ...GROUND, file: "synthetic 1" },
  record: { ...GROUND, file: "" },
};

function kindOfLoading({ drive, file, protocol, amplitudes, values }) {
  if (drive === "ground_acceleration") return file?.startsWith("synthetic ") ? "synthetic" : "record";
  return protocol ? "named" : amplitudes ? "amplitudes" : values && values.length <= 1 ? "push" : "path";
}
export const isShaken = groups => !isText(groups) && valuesOf(groups, "loading")?.drive === "ground_acceleration";

// The record along y of a building in plan.
const DRIVE_Y = "ground_acceleration_y";
export const ALONG_Y = { path: "loading.seed_y", label: "Number of that along y", dimension: "number", whole: true, step: 1, optional: "none", kinds: ["synthetic"] };
const alongY = groups => groups.find(([name, { drive }]) => name === "loading" && drive === DRIVE_Y);

// What a field of the loading shows, also of those that stand for several keys; and what it does to the loading.
export function loadingValue(groups, key) {
  const loading = valuesOf(groups, "loading") ?? {}, across = alongY(groups);
  if (key === "kind") return kindOfLoading(loading);
  if (key.startsWith("seed")) return key === "seed" ? Number(loading.file?.split(" ")[1]) : across && Number(across[1].file?.split(" ")[1]);
  return key === "scale" ? loading.scale ?? 1 : loading[key];
}
export function putLoading(groups, key, value) {
  if (!groupOf(groups, "loading")) groups.push(["loading", {}]);
  const loading = groupOf(groups, "loading"), across = alongY(groups);
  if (key === "kind") {
    if (value !== kindOfLoading(loading[1])) loading[1] = JSON.parse(JSON.stringify(LOADINGS[value] ?? loading[1]));
    // A method that was for the loading before, and a record along y
    groups.splice(0, groups.length, ...groups.filter(one => one[0] !== "analysis" && one !== across));
  } else if (key === "seed") loading[1].file = `synthetic ${value}`;
  else if (key.endsWith("_y")) {
    if (across) groups.splice(groups.indexOf(across), 1);
    const file = key === "seed_y" ? `synthetic ${value}` : value;
    if (value !== null) groups.splice(groups.indexOf(loading) + 1, 0, ["loading", { ...loading[1], drive: DRIVE_Y, file }]);
  } else {
    putAt(groups, `loading.${key}`, value);
    if (key === "scale" && across) across[1].scale = value;
  }
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

// Fields by the names of their groups and keys; of several the first.
export const fieldsOf = fields => Object.fromEntries(fields.toReversed().map(field => [namedPath([], field.path), field]));

// A message of the program as the page says it: with the label and the unit of its field; an empty field says what it lacks.
export function toldAs(fault, known, groups, system) {
  const path = namedPath(groups, fault.field), field = known[path], value = fault.field && valueAt(groups, fault.field);
  if (!field) return inUnits(fault.text, system);
  const label = field.label.split(",")[0], [unit] = field.dimension ? unitOf(system, field.dimension) : [""];
  if (!field.optional && !field.choices && (value === undefined || value === null || value === "" || value.length === 0))
    return `${label}: give ${field.whole ? "a whole number" : unit ? `a value in ${unit}` : field.text ? "a name" : "a number"}`;
  return inUnits(fault.text, system, field.dimension).replace(new RegExp(`^(?:[a-z_ ]+(?:\\(\\d+\\))?: )?${path.split(".")[1]}(?:\\(\\d+\\))? = `), `${label} = `);
}

function shownValue(field, value, system) {
  const [, factor] = field.dimension ? unitOf(system, field.dimension) : ["", 1];
  if (Array.isArray(value)) return value.map(v => typed(v, factor)).join(", ");
  return typed(value, factor);
}

function readValue(field, text, system) {
  if (field.text) return text.trim() || null;
  const [, factor] = unitOf(system, field.dimension);
  if (!field.list) return field.several && text.trim() ? [parsed(text, factor, field.whole)] : parsed(text, factor, field.whole);
  return text.split(/[\s;,]+/).filter(Boolean).map(word => parsed(word, factor, field.whole)).filter(value => value !== null);
}

const idOf = path => "f-" + path.replaceAll(/[.@]/g, "-");

// The input of a field; `edit(value, done)` is called while one types and when it is left. `at` is the path that messages have.
function inputOf(field, value, system, edit, fixed, at = field.path, id = idOf(field.path)) {
  let input;
  if (field.choices) {
    input = element("select", { id, disabled: fixed });
    for (const [key, text] of field.choices) input.append(element("option", { value: String(key), selected: key === (value ?? field.usual ?? field.choices[0][0]) }, text));
    input.addEventListener("change", () => edit(field.choices.find(([key]) => String(key) === input.value)[0], true));
  } else {
    const given = { id, value: shownValue(field, value, system), readOnly: fixed, spellcheck: false };
    input = field.list ? element("textarea", { ...given, rows: field.rows ?? 2 }) : element("input", { ...given, type: "text", inputMode: field.text ? "text" : "decimal" });
    input.placeholder = field.optional ?? "needed";
    input.addEventListener("input", () => edit(readValue(field, input.value, system), false));
    input.addEventListener("change", () => edit(readValue(field, input.value, system), true));
    input.addEventListener("keydown", event => {
      const way = { ArrowUp: 1, ArrowDown: -1, PageUp: 5, PageDown: -5 }[event.key];
      const now = way && !field.text && readValue({ ...field, several: false }, input.value, system);
      if (!way || fixed || !(field.step || field.bar) || typeof now !== "number") return;
      event.preventDefault();
      const step = field.bar ? 0 : stepOf(system, field.dimension, field.step);
      const next = field.bar ? barSize(system, now, way) : Math.round((now + way * step) / step * 1e6) / 1e6 * step;
      input.value = shownValue(field, Number(next.toPrecision(10)), system);
      edit(readValue(field, input.value, system), false);
    });
  }
  input.dataset.path = at;
  return input;
}

// One labelled field with its message.
export function fieldRow(field, value, system, edit, fixed, at = field.path) {
  const id = idOf(field.path), message = id + "-fault", input = inputOf(field, value, system, edit, fixed, at);
  const row = element("div", { className: "row" }, element("label", { htmlFor: id }, field.label));
  const [unit] = field.dimension ? unitOf(system, field.dimension) : [""];
  input.setAttribute("aria-describedby", message);
  const box = element("span", { className: "value" }, input);
  if (unit) {
    box.append(element("span", { className: "unit", id: id + "-unit" }, unit));
    input.setAttribute("aria-describedby", `${message} ${id}-unit`);
  }
  row.append(box, element("p", { className: "fault", id: message, hidden: true }));
  return row;
}

// Groups of one name, one a row with a cell for each key, a button that removes it, and one that adds another.
// A cell is a field, or { label, choices, get, set } for what stands for several keys; `act(change)` does what is done at once.
export function listRows(name, cells, { groups, own = groups, system, edit, act, fixed, add, least = 0, fits = () => true, what = name }) {
  const rows = own.filter(one => one[0] === name && fits(one[1])), made = [];
  if (rows.length) made.push(element("div", { className: "heads" }, ...cells.map(cell => {
    const [unit] = cell.dimension ? unitOf(system, cell.dimension) : [""];
    return element("span", {}, cell.label + (unit ? `, ${unit}` : ""));
  })));
  rows.forEach((one, i) => {
    const message = `f-${name}-${i + 1}-fault`, at = groups.indexOf(one);
    const inputs = cells.map(cell => {
      const id = `f-${name}-${i + 1}-${cell.key}`, value = cell.get ? cell.get(one[1]) : one[1][cell.key];
      const take = cell.set ? chosen => act(() => cell.set(one[1], chosen)) : (given, done) => edit(`${at}.${cell.key}`, given, done);
      const input = inputOf(cell, value, system, take, fixed, `${at}.${cell.key}`, id);
      input.ariaLabel = `${cell.label} of ${what} ${i + 1}`;
      input.setAttribute("aria-describedby", message);
      return input;
    });
    const gone = element("button", { type: "button", className: "gone", ariaLabel: `Remove ${what} ${i + 1}`, title: "Remove", disabled: fixed || rows.length <= least, onclick: () => act(() => groups.splice(groups.indexOf(one), 1)) }, "×");
    made.push(element("div", { className: "row cells" }, ...inputs, gone, element("p", { className: "fault", id: message, hidden: true })));
  });
  if (!fixed && add) made.push(element("button", { type: "button", className: "add", id: `add-${name}`, onclick: () => act(() => {
    const last = rows.at(-1) ?? own.findLast(one => one[0] === name) ?? own.at(-1);
    groups.splice(groups.indexOf(last) + 1, 0, [name, add(rows.at(-1)?.[1])]);
  }) }, `Add ${what}`));
  for (const row of made) row.style?.setProperty("--cells", cells.length);
  return made;
}

// Fields under a title; none without fields.
export function fieldGroup(title, rows) {
  return rows.length ? [element("fieldset", {}, element("legend", {}, title), ...rows)] : [];
}

// The fields of a loading, with the buttons that open records. `edit(path, value, done)`.
export function loadingRows(groups, system, edit, fixed, fields = LOADING_FIELDS) {
  const loading = valuesOf(groups, "loading") ?? {}, kind = kindOfLoading(loading);
  const rows = fields
    .filter(field => !field.kinds || field.kinds.includes(kind))
    .map(field => {
      const own = kind === "path" && field.path === "loading.kind" ? { ...field, choices: [["path", `path of ${loading.values?.length ?? 0} points`], ...field.choices] } : field;
      return fieldRow(own, loadingValue(groups, parts(field.path)[1]), system, (value, done) => edit(field.path, value, done), fixed, placeOf(groups, field.path));
    });
  if (kind === "record") {
    const buttons = [["Record", "file", groupOf(groups, "loading")], ["Record along y", "file_y", alongY(groups)]].slice(0, fields.includes(ALONG_Y) ? 2 : 1);
    rows.splice(1, 0, ...buttons.map(([label, key, own], i) => {
      const id = `f-loading-${key}`, hint = "A file .at2 of the PEER database, or .csv or .txt whose first line names the columns with their units, as time_s, acceleration_g (or m/s2, cm/s2).";
      const button = element("button", { type: "button", disabled: fixed, id }, own?.[1].file?.split("#")[0] || `Open a ${label.toLowerCase()}…`);
      button.addEventListener("click", () => { const chosen = document.getElementById("recordfile"); chosen.dataset.key = key; chosen.click(); });
      button.setAttribute("aria-describedby", `${id}-fault ${id}-hint`);
      button.dataset.path = `${groups.indexOf(own)}.file`;
      return element("div", { className: "row" }, element("span", {}, label), button, element("p", { className: "fault", id: `${id}-fault`, hidden: true }),
        element("p", { className: "hint", id: `${id}-hint` }, i ? "" : hint));
    }));
  }
  return rows;
}

// Put the messages beside their fields; what has no field is returned.
export function showFaults(form, faults) {
  const shown = new Set();
  for (const row of form.querySelectorAll(".row")) {
    const place = row.querySelector(".fault"), texts = [];
    for (const input of row.querySelectorAll("[data-path]")) {
      const mine = faults.filter(fault => fault.field === input.dataset.path);
      shown.add(input.dataset.path);
      texts.push(...mine.map(fault => fault.told ?? fault.text));
      if (mine.length) input.setAttribute("aria-invalid", "true");
      else input.removeAttribute("aria-invalid");
    }
    if (!place) continue;
    const text = [...new Set(texts)].join("\n");
    if (place.textContent !== text) place.textContent = text;
    place.hidden = !text;
  }
  return faults.filter(fault => !shown.has(fault.field)).map(fault => (fault.of ? `${fault.of}: ` : "") + (fault.told ?? fault.text));
}

// The values of fields anew, except of the one that is being typed in.
export function refreshFields(form, fields, valueOf, system) {
  for (const field of fields) {
    const input = form.querySelector(`[id="${idOf(field.path)}"]`);
    if (!input || input === document.activeElement) continue;
    const value = valueOf(field.path);
    if (field.choices) input.value = String(value ?? field.usual ?? field.choices[0][0]);
    else input.value = shownValue(field, value, system);
  }
}
