// The form of a section: its shape, concrete, bars and hoops, as the groups of a drawing.

import { fieldGroup, fieldRow, groupOf, listRows, placeOf, valueAt, valuesOf } from "./fields.js";

const ROUND = ["circle", "hollow_circle"], BOXED = ["rectangle", "hollow_rectangle", "tee"], TIED = [...BOXED];
const HOLLOW = ["hollow_rectangle", "hollow_circle"];
const SHAPES = [["rectangle", "rectangle"], ["circle", "circle"], ["hollow_rectangle", "hollow rectangle"], ["hollow_circle", "ring"], ["tee", "beam with a slab"], ["wall", "wall"]];
// Sizes of each shape, beside those that all have.
const SIZES = { rectangle: ["width", "depth"], hollow_rectangle: ["width", "depth", "wall", "side_wall"], circle: ["diameter"], hollow_circle: ["diameter", "wall"], tee: ["width", "depth", "flange_width", "flange_thickness", "flange_below"], wall: ["width", "depth"] };
const ALWAYS = ["shape", "cover", "side_cover", "bar_diameter", "strips"];

const length = (path, label, step = 0.01) => ({ path, label, dimension: "length", step }), bar = (path, label = "Diameter") => ({ path, label, dimension: "length", bar: true });
const stress = (path, label = "Yield stress", more = {}) => ({ path, label, dimension: "stress", step: 1e7, ...more }), count = (path, label, more = {}) => ({ path, label, dimension: "number", step: 1, ...more });
const hoops = (group, more) => [
  { ...bar(`${group}.diameter`), ...more }, { ...length(`${group}.spacing`, "Spacing", 0.005), ...more },
  ...(group === "ties" ? [count("ties.legs", "Legs along the load", { optional: "2", ...more }), count("ties.legs_across", "Legs across", { optional: "as along", ...more })] : []),
  stress(`steel@${group}.fy`, "Yield stress", more), stress(`steel@${group}.fu`, "Ultimate stress", { optional: "1.5 × yield", ...more }),
];
// path, label, dimension, step of the arrow keys in SI, and for which shapes; `group` fields need that group to be there.
export const SECTION_FIELDS = [
  { group: "Section", fields: [
    { path: "section.shape", label: "Shape", choices: SHAPES },
    { ...length("section.width", "Width"), shapes: BOXED },
    { ...length("section.depth", "Depth, along the load"), shapes: BOXED },
    { ...length("section.depth", "Length of the wall", 0.1), shapes: ["wall"] },
    { ...length("section.width", "Thickness"), shapes: ["wall"] },
    { ...length("section.diameter", "Diameter"), shapes: ROUND },
    { ...length("section.wall", "Wall"), shapes: HOLLOW },
    { ...length("section.side_wall", "Side walls"), shapes: ["hollow_rectangle"] },
    { ...length("section.flange_thickness", "Thickness of the slab"), shapes: ["tee"] },
    { ...length("section.flange_width", "Effective width of the slab", 0.05), shapes: ["tee"] },
    length("section.cover", "Clear cover to hoops", 0.001),
    { path: "concrete.fc", label: "Concrete strength", dimension: "stress", step: 1e6 },
  ] },
  { group: "Longitudinal bars", fields: [
    { path: "bars.kind", label: "Bars", shapes: ["rectangle"], choices: [["layout", "equal, around"], ["row", "in rows"]] },
    count("layout.number", "Number", { whole: true, needs: "layout" }),
    count("layout.face", "On the tension face", { whole: true, optional: "number/4 + 1", shapes: BOXED, needs: "layout" }),
    { ...bar("layout.diameter"), needs: "layout" },
    stress("steel@layout.fy", "Yield stress", { needs: "layout" }),
    stress("steel@layout.fu", "Ultimate stress", { optional: "1.5 × yield", needs: "layout" }),
    "row",
    stress("steel@row.fy", "Yield stress", { needs: "row" }),
    stress("steel@row.fu", "Ultimate stress", { optional: "1.5 × yield", needs: "row" }),
  ] },
  { group: "Boundary elements", fields: [
    length("boundary.length", "Length, from the end", 0.05), { ...length("boundary.thickness", "Thickness"), optional: "of the wall" },
    { ...bar("boundary.hoop_diameter", "Diameter of the hoops"), optional: "no hoops" }, { ...length("boundary.hoop_spacing", "Spacing of the hoops", 0.005), optional: "no hoops" },
    count("boundary.legs_along", "Legs along the wall", { optional: "2" }), count("boundary.legs_across", "Legs across", { optional: "2" }),
  ].map(field => ({ ...field, shapes: ["wall"] })) },
  { group: "Bars of the web", fields: ["curtain", stress("steel@curtain.fy", "Yield stress, hoops too", { needs: "curtain" })] },
  { group: "Transverse bars", fields: [
    { path: "spiral.hoops", label: "Kind", choices: [[false, "spiral"], [true, "single hoops"]], shapes: ROUND },
    ...hoops("spiral", { shapes: ROUND }), ...hoops("ties", { shapes: TIED }),
  ] },
  { group: "Lap at the foot", fields: [
    { ...length("lap.length", "Length of the lap", 0.05), shapes: ["rectangle"], optional: "no lap" },
    { ...length("lap.development_length", "Development length", 0.05), shapes: ["rectangle"], optional: "of ACI 318-19", needs: "lap" },
  ] },
];
const CELLS = {
  row: [
    { key: "face", label: "face", choices: [["top", "top"], ["side", "each side"], ["bottom", "bottom"]] },
    { key: "number", label: "bars", dimension: "number", whole: true, step: 1 },
    { key: "diameter", label: "size", dimension: "length", bar: true },
    { key: "clear", label: "clear", dimension: "length", step: 0.005, optional: "–" },
  ],
  curtain: [
    { key: "direction", label: "bars", choices: [["vertical", "upright"], ["horizontal", "level"]] },
    { key: "diameter", label: "size", dimension: "length", bar: true },
    { key: "spacing", label: "every", dimension: "length", step: 0.025 },
    { key: "faces", label: "layers", dimension: "number", whole: true, step: 1, optional: "2" },
  ],
};
const OF_WALL = [{ key: "face", label: "end", choices: [["both", "both"], ["start", "left"], ["end", "right"]] }, ...CELLS.row.slice(1)];
export const SECTION_KEYS = [...SECTION_FIELDS.flatMap(({ fields }) => fields).filter(field => field.path),
  ...Object.entries(CELLS).flatMap(([name, cells]) => cells.map(cell => ({ ...cell, path: `${name}.${cell.key}` })))];

export const shapeOf = own => String(valuesOf(own, "section")?.shape ?? "rectangle");
const barsOf = own => groupOf(own, "layout") ? "layout" : "row";

// What a field of a section shows.
export const sectionValue = (own, path) => path === "bars.kind" ? barsOf(own) : valueAt(own, path);

// The fields of the groups `own` of one drawing among all `groups`. `edit(path, value, done)`, `act(change)`.
export function sectionRows(groups, own, { system, edit, act, fixed, shapes }) {
  const shape = shapeOf(own), about = { groups, own, system, edit, act, fixed };
  return SECTION_FIELDS.flatMap(({ group, fields }) => fieldGroup(group, fields.flatMap(field => {
    if (field === "row") return groupOf(own, "layout") || ROUND.includes(shape) ? [] : listRows("row", shape === "wall" ? OF_WALL : CELLS.row, { ...about, what: "row", least: 1, add: last => ({ ...(last ?? { number: 2, diameter: 0.016, steel: 1 }), face: shape === "wall" ? "both" : "side" }) });
    if (field === "curtain") return shape === "wall" ? listRows("curtain", CELLS.curtain, { ...about, what: "mesh", least: 1, add: last => ({ ...last, direction: "horizontal" }) }) : [];
    if ((field.shapes && !field.shapes.includes(shape)) || (field.needs && !groupOf(own, field.needs))) return [];
    const known = field.path === "section.shape" ? { ...field, choices: field.choices.filter(([key]) => shapes.includes(key)) } : field;
    return [fieldRow(known, sectionValue(own, field.path), system, (value, done) => edit(field.path, value, done), fixed, placeOf(groups, field.path, own))];
  })));
}

const steelOf = own => (groupOf(own, "layout") ?? groupOf(own, "row"))?.[1].steel ?? 1;
const sized = (number, otherwise) => typeof number === "number" && number > 0 ? number : otherwise;
const inRows = (size, steel) => [["row", { face: "top", number: 3, diameter: size, steel }], ["row", { face: "bottom", number: 3, diameter: size, steel }]];

// Another shape, or bars in another way: the groups that it needs in place of those that it has not.
function reshape(groups, own, shape, bars = ["tee", "wall"].includes(shape) ? "row" : "layout") {
  const before = { ...valuesOf(own, "section") }, section = groupOf(own, "section")[1], steel = steelOf(own), round = ROUND.includes(shape);
  const size = sized(before.width ?? before.diameter, 0.4), hoop = groupOf(own, "ties") ?? groupOf(own, "spiral"), bar = sized((groupOf(own, "layout") ?? groupOf(own, "row"))?.[1].diameter, 0.016);
  for (const key of Object.keys(section)) if (!ALWAYS.includes(key) && !SIZES[shape].includes(key)) delete section[key];
  section.shape = shape;
  if (round) section.diameter ??= size;
  else { section.width ??= size; section.depth ??= size; }
  if (HOLLOW.includes(shape)) section.wall ??= Number((0.25 * (round ? section.diameter : Math.min(section.width, section.depth))).toPrecision(3));
  if (shape === "hollow_rectangle") section.side_wall ??= section.wall;
  if (shape === "tee") { section.flange_thickness ??= 0.12; section.flange_width ??= Number((4 * section.width).toPrecision(3)); }
  if (shape === "wall" && before.shape !== "wall") { section.width = 0.2; section.depth = 2; }
  const hooped = hoop?.[1].steel ?? 2, { diameter = 0.008, spacing = 0.1 } = hoop?.[1] ?? {}, gone = new Set();
  const keep = (name, is) => { for (const one of own) if (one[0] === name && !is) gone.add(one); };
  keep("ties", TIED.includes(shape)); keep("spiral", round); keep("boundary", shape === "wall"); keep("curtain", shape === "wall"); keep("lap", shape === "rectangle");
  keep("layout", bars === "layout"); keep("row", bars === "row" && (shape === "wall") === (before.shape === "wall"));
  const left = own.filter(one => !gone.has(one)), missing = name => !groupOf(left, name), added = [];
  if (bars === "layout" && missing("layout")) added.push(["layout", { number: 8, diameter: bar, steel }]);
  if (bars === "row" && missing("row")) added.push(...(shape === "wall" ? [["row", { face: "both", number: 4, diameter: bar, steel }]] : inRows(bar, steel)));
  if (TIED.includes(shape) && missing("ties")) added.push(["ties", { diameter, spacing, steel: hooped }]);
  if (round && missing("spiral")) added.push(["spiral", { diameter, spacing, steel: hooped }]);
  if (shape === "wall" && missing("boundary")) added.push(["boundary", { length: 0.3, hoop_diameter: diameter, hoop_spacing: spacing, steel: hooped }]);
  if (shape === "wall" && missing("curtain")) added.push(...["vertical", "horizontal"].map(direction => ["curtain", { direction, diameter: 0.01, spacing: 0.2, steel: hooped }]));
  const at = groups.indexOf(own.at(-1)) + 1;
  groups.splice(at, 0, ...added);
  for (const one of gone) groups.splice(groups.indexOf(one), 1);
}

// A choice of the form brings the groups and values that it needs; whether it did.
export function completeSection(groups, own, path, value) {
  if (path === "section.shape") reshape(groups, own, value);
  else if (path === "bars.kind") reshape(groups, own, shapeOf(own), value);
  else return false;
  return true;
}
