// Units on the page; all numbers of a state are SI.

export const SYSTEMS = {
  "mm": { label: "mm, kN, MPa", length: ["mm", 1e-3], force: ["kN", 1e3], stress: ["MPa", 1e6],
    moment: ["kN m", 1e3], curvature: ["mrad/m", 1e-3], mass: ["t", 1e3], energy: ["kJ", 1e3] },
  "m": { label: "m, kN, MPa", length: ["m", 1], force: ["kN", 1e3], stress: ["MPa", 1e6],
    moment: ["kN m", 1e3], curvature: ["1/m", 1], mass: ["t", 1e3], energy: ["kJ", 1e3] },
  "si": { label: "m, N, Pa", length: ["m", 1], force: ["N", 1], stress: ["Pa", 1],
    moment: ["N m", 1], curvature: ["1/m", 1], mass: ["kg", 1], energy: ["J", 1] },
  "in": { label: "in, kip, ksi", length: ["in", 0.0254], force: ["kip", 4448.2216152605],
    stress: ["ksi", 6894757.293168], moment: ["kip in", 112.9848290276], curvature: ["1/in", 39.37007874015748],
    mass: ["kip (weight)", 453.59237], energy: ["kip in", 112.9848290276] },
};
for (const [key, system] of Object.entries(SYSTEMS)) {
  system.line = { mm: ["kN/m", 1e3], m: ["kN/m", 1e3], si: ["N/m", 1], in: ["kip/ft", 14593.90293720636] }[key];
  system.area = { mm: ["kN/m²", 1e3], m: ["kN/m²", 1e3], si: ["N/m²", 1], in: ["psf", 47.88025898033584] }[key];
  system.turning = [`${system.moment[0]}/rad`, system.moment[1]];
  system.stiffness = [`${system.force[0]}/${system.length[0]}`, system.force[1] / system.length[1]];
}
const FIXED = { drift: ["%", 1e-2], number: ["", 1], ratio: ["", 1], share: ["%", 1e-2] };

export function unitOf(system, dimension) {
  return FIXED[dimension] ?? SYSTEMS[system][dimension];
}

// A number for people: four digits, no trailing zeros, no exponent where it can be helped.
export function shown(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(digits));
  if (size >= 1e6 || size < 1e-4) return rounded.toExponential().replace("e+", "e").replace("-", "−");
  return String(rounded).replace("-", "−");
}

// What stands in a field: what was typed, or five digits of a number typed in other units.
export function typed(value, factor) {
  if (value === null || value === undefined) return "";
  if (typeof value !== "number") return String(value);
  const number = Number((value / factor).toPrecision(12));
  const digits = number.toExponential().replace(/e.*|\D/g, "").length;
  return String(digits > 9 ? Number(number.toPrecision(5)) : number);
}

// The value of a field in SI; a text that is no number is sent as it is, and the program says so.
export function parsed(text, factor, whole = false) {
  const word = text.trim().replace("−", "-");
  if (word === "") return null;
  const number = Number(/^[^.,]*,[^.,]*$/.test(word) ? word.replace(",", ".") : word);
  if (!Number.isFinite(number)) return word;
  return whole ? number : Number((number * factor).toPrecision(14));
}

// The step of a field or handle: that of SI where it is round in these units too, else the nearest round one.
export function stepOf(system, dimension, step) {
  const [, factor] = unitOf(system, dimension), raw = step / factor, power = 10 ** Math.floor(Math.log10(raw) + 1e-9);
  const near = [1, 2, 5, 10].reduce((best, one) => Math.abs(Math.log(one * power / raw)) < Math.abs(Math.log(best * power / raw)) ? one : best);
  return near * power * factor;
}

// Diameters of bars: EN 10080 in mm, and ASTM A615, No. 3 to No. 18, in inches.
const METRIC_BARS = [6, 8, 10, 12, 14, 16, 20, 25, 28, 32, 40, 50].map(size => size / 1e3);
const INCH_BARS = [0.375, 0.5, 0.625, 0.75, 0.875, 1, 1.128, 1.27, 1.41, 1.693, 2.257].map(size => Number((size * 0.0254).toPrecision(10)));

// The size of a bar nearest to a diameter, or some sizes above or below it.
export function barSize(system, diameter, way = 0) {
  const sizes = system === "in" ? INCH_BARS : METRIC_BARS, last = sizes.length - 1;
  if (!way) return sizes.reduce((best, size) => Math.abs(size - diameter) < Math.abs(best - diameter) ? size : best);
  const below = sizes.findLastIndex(size => size < diameter * (1 - 1e-9)), above = sizes.findIndex(size => size > diameter * (1 + 1e-9));
  const at = way > 0 ? (above < 0 ? last : above + way - 1) : (below < 0 ? 0 : below + way + 1);
  return sizes[Math.max(0, Math.min(last, at))];
}

// A message of the program in the units of the page. Its bounds have no unit: they are in that of the field.
const SI = { m: ["length", 1, 1], m2: ["length", 1, 2], N: ["force", 1, 1], Pa: ["stress", 1, 1], MPa: ["stress", 1e6, 1], kg: ["mass", 1, 1], "N m": ["moment", 1, 1], "N/m": ["line", 1, 1] };
const NUMBER = "-?\\d+(?:\\.\\d+)?(?:e[+-]?\\d+)?";
const QUANTITY = new RegExp(`(?<![\\w.'])(${NUMBER})(?: to (${NUMBER}))?(?: (m2|m|N m|N/m|N|Pa|MPa|kg)(?![\\w/2]))?`, "g");

export function inUnits(text, system, dimension) {
  if (system === "si") return text;
  const own = dimension && dimension !== "number" ? unitOf(system, dimension) : ["", 1];
  // How other units are written in SI helps nobody here.
  return text.replace(/ \([\d.]+ \w+ is [^)]*\)|;[^;]*?\b[\d.]+ \w+ is [\d.e-]+(?=;|$)/g, "").replace(QUANTITY, (all, low, high, unit, at) => {
    const bound = /(=|must be|from|between|above|below|and) $/.test(text.slice(0, at)) || high;
    if (!unit && (!own[0] || !bound)) return all;
    const [of, times, power] = SI[unit] ?? [], [name, factor] = unit ? unitOf(system, of) : own;
    const values = [low, high].filter(one => one !== undefined).map(one => shown(one * (times ?? 1) / factor ** (power ?? 1), 5));
    return `${values.join(" to ")} ${name}${power === 2 ? "2" : ""}`;
  });
}
