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
const FIXED = { drift: ["%", 1e-2], number: ["", 1], ratio: ["", 1], drifts: ["%", 1e-2] };

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

// What stands in a field: enough digits that nothing is lost by looking at it.
export function typed(value, factor) {
  if (value === null || value === undefined) return "";
  if (typeof value !== "number") return String(value);
  const number = Number((value / factor).toPrecision(12));
  return Math.abs(number) >= 1e15 ? String(number) : number.toString();
}

// The value of a field in SI; a text that is no number is sent as it is, and the program says so.
export function parsed(text, factor, whole = false) {
  const word = text.trim().replace("−", "-");
  if (word === "") return null;
  const number = Number(/^[^.,]*,[^.,]*$/.test(word) ? word.replace(",", ".") : word);
  if (!Number.isFinite(number)) return word;
  return whole ? number : Number((number * factor).toPrecision(14));
}
