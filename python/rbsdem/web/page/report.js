// A report of columns: the page with the answers to its one input, which asks nothing.

import { addView, get, page, report, setUp, stand } from "./machine.js";
import { columnLanes, columnsView } from "./columns.js";

function standReport() {
  const code = get("code").value, { state } = columnsView;
  for (const [name, found] of Object.entries({ loops: report.loops, sections: report.sections[code], bands: report.bands, scales: report.scales, own: report.own }))
    if (found) stand(columnsView, name, { columns: found }, { state, code: columnsView.codeOf(name) });
  if (report.near) stand(columnsView, "near", report.near, { state });
  columnsView.latest = columnsView.stood.loops;
  columnsView.showAll();
}

addView(columnsView, columnLanes);
page.view = columnsView;
columnsView.state = report.state;
setUp();
document.body.classList.add("report");
get("units").value = page.system;
get("subtitle").textContent = report.title;
for (const id of ["undo", "redo", "open", "link", "drawhint"]) get(id).hidden = true;
for (const panel of document.querySelectorAll('[data-view="frame"]')) panel.hidden = true;
for (const option of [...get("export").options]) if (option.value && !report.exports[option.value]) option.remove();
get("code").addEventListener("change", standReport);
standReport();
