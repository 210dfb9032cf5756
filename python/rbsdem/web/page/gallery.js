// All predicted tests, to sort and to filter.

import { SYSTEMS, shown } from "./units.js";
import { element } from "./fields.js";
import { table, testCard } from "./panels.js";

function showGallery(data) {
  const get = id => document.getElementById(id);
  get("subtitle").textContent = data.title;
  const digits = Object.entries(data.digits), fix = (value, n) => value === null ? "–" : value.toFixed(n).replace("-", "−");
  const rows = data.groups.map(group => ({ cells: [group.name, group.tests, group.stopped, group.failed,
    ...digits.map(([name, n]) => { const [median, low, high] = group.scores[name]; return `${fix(median, n)} (${fix(low, n)} to ${fix(high, n)})`; })] }));
  get("groups").append(table(["Median, quartiles", "tests", "early end", "failed", ...digits.map(([name]) => name.replaceAll("_", " "))], rows, ""));
  for (const mode of new Set(data.tests.map(test => test.failure))) get("mode").append(element("option", { value: mode }, mode));
  for (const [key, { label }] of Object.entries(SYSTEMS)) get("units").append(element("option", { value: key }, label));
  const all = data.tests.map((test, place) => ({ test, place, card: null }));
  const score = (one, name) => one.test.scores[name] ?? -Infinity;
  const orders = {
    table: (a, b) => a.place - b.place,
    smallest: (a, b) => score(a, "nrmse") - score(b, "nrmse"),
    axial: (a, b) => (b.test.axial_load_ratio ?? 0) - (a.test.axial_load_ratio ?? 0),
    name: (a, b) => a.test.name.localeCompare(b.test.name),
  };
  function show() {
    const key = get("sort").value, mode = get("mode").value, words = get("name").value.toLowerCase();
    const chosen = all.filter(({ test }) => (!mode || test.failure === mode) && test.name.toLowerCase().includes(words));
    chosen.sort(orders[key] ?? ((a, b) => score(b, key) - score(a, key) || a.place - b.place));
    for (const one of chosen) one.card ??= testCard(one.test, get("units").value);
    get("cards").replaceChildren(...chosen.map(one => one.card));
    get("count").textContent = `${shown(chosen.length)} of ${all.length}`;
  }
  for (const [id, event] of [["sort", "change"], ["mode", "change"], ["name", "input"]]) get(id).addEventListener(event, show);
  get("units").addEventListener("change", () => { for (const one of all) one.card = null; show(); });
  document.querySelector("form").addEventListener("submit", event => event.preventDefault());
  show();
}

showGallery(JSON.parse(document.getElementById("report").textContent));
