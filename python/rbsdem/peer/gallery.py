"""All loops on one page of html, drawn as svg, to sort and to filter."""

from __future__ import annotations

import html
import math
from pathlib import Path

import numpy as np

from rbsdem._core import Array
from rbsdem._views import view_of
from rbsdem.peer.predictions import Group, Prediction, Predictions

__all__ = ["svg_path", "write_gallery"]

# Size of a picture in its own units, a quarter of a pixel, and the room its axes leave.
_WIDTH, _HEIGHT = 1200, 880
_REACH = 0.92


def svg_path(x: Array, y: Array) -> str:
    """Return a line as the data of an svg path, without points that nobody would see.

    Parameters
    ----------
    x, y : ndarray, shape (m,)
        In units of the picture.

    Returns
    -------
    str
        Whole numbers.
    """
    points = np.rint(thinned(np.column_stack((x, y)))).astype(np.int64)
    return "M" + " ".join(f"{a},{b}" for a, b in points.tolist())


def thinned(points: Array, tolerance: float = 1.0) -> Array:
    """Leave out points that lie on the straight way between their neighbours.

    Every other point at a time, so that no two neighbours go at once.

    Parameters
    ----------
    points : ndarray, shape (m, 2)
        A line.
    tolerance : float, optional
        Distance from the way at which a point may lie; errors do not add up beyond a few of it.

    Returns
    -------
    ndarray, shape (k, 2)
        First, last and all corners are kept.
    """
    for turn in range(12):
        first = 1 + turn % 2
        inner = np.arange(first, len(points) - 1, 2)
        if not inner.size:
            break
        way = points[inner + 1] - points[inner - 1]
        out = points[inner] - points[inner - 1]
        length = np.maximum(np.hypot(*way.T), 1e-9)
        aside = np.abs(way[:, 0] * out[:, 1] - way[:, 1] * out[:, 0]) / length
        along = np.sum(way * out, axis=1) / length
        drop = (aside <= tolerance) & (along >= -tolerance) & (along <= length + tolerance)
        points = np.delete(points, inner[drop], axis=0)
    return points


@view_of(Predictions, "gallery")
def write_gallery(predictions: Predictions, path: Path) -> Path:
    """Write the page."""
    path.parent.mkdir(parents=True, exist_ok=True)
    cards = "\n".join(_card(row) for row in predictions)
    modes = dict.fromkeys(row.specimen.failure_mode or "not known" for row in predictions)
    options = "".join(f"<option>{html.escape(mode)}</option>" for mode in modes)
    title = f"Loops of {len(predictions)} tests, model {html.escape(predictions.model)}"
    page = _PAGE.replace("{title}", title).replace("{options}", options)
    page = page.replace("{summary}", _summary(predictions.summary())).replace("{cards}", cards)
    path.write_text(page, encoding="utf-8")
    return path


def _summary(groups: list[Group]) -> str:
    names = {"nrmse": 3, "peak_ratio": 2, "energy_ratio": 2, "stiffness_ratio": 2, "end_ratio": 2}
    head = "".join(f"<th>{name.replace('_', ' ')}</th>" for name in names)
    rows = []
    for group in groups:
        cells = []
        for name, digits in names.items():
            q = group.quartiles[name]
            cells.append(
                f"<td>{_number(q.median, digits)} <small>{_number(q.lower, digits)} "
                f"{_number(q.upper, digits)}</small></td>"
            )
        counts = "".join(f"<td>{n}</td>" for n in (group.tests, group.stopped, group.failed))
        rows.append(f"<tr><th>{html.escape(group.name)}</th>{counts}{''.join(cells)}</tr>")
    return (
        "<table><tr><th>Median, quartiles</th><th>tests</th><th>early end</th><th>failed</th>"
        f"{head}</tr>{''.join(rows)}</table>"
    )


def _card(row: Prediction) -> str:
    s = row.specimen
    mode = s.failure_mode or "not known"
    sort = {
        "mode": mode,
        "name": s.name,
        "nrmse": _number(row.nrmse, 6),
        "peak": _number(row.score("peak_ratio"), 6),
        "energy": _number(row.score("energy_ratio"), 6),
        "axial": _number(s.axial_load_ratio, 6),
    }
    data = " ".join(f'data-{key}="{html.escape(value)}"' for key, value in sort.items())
    facts = (
        f"{html.escape(mode)}, {html.escape(s.section)}, N/(f<sub>c</sub>A) "
        f"{s.axial_load_ratio:.2f}, L/h {s.span_depth_ratio:.1f}"
    )
    scores = (
        f"NRMSE <b>{_number(row.nrmse, 3)}</b> peak {_number(row.score('peak_ratio'), 2)} "
        f"energy {_number(row.score('energy_ratio'), 2)} "
        f"K {_number(row.score('stiffness_ratio'), 2)} end {_number(row.score('end_ratio'), 2)}"
    )
    error = ""
    if row.status != "completed":
        error = f"<p class=error>{html.escape(row.status)}: {html.escape(row.error)}</p>"
    picture = _picture(row) if row.comparison is not None else ""
    return (
        f"<figure {data}><figcaption><b>{html.escape(s.name)}</b><br>{facts}</figcaption>"
        f"{picture}<p>{scores}</p>{error}</figure>"
    )


def _picture(row: Prediction) -> str:
    c = row.comparison
    assert c is not None
    model = c.model_force[: c.rows]
    x_reach = float(np.max(np.abs(c.displacement))) or 1.0
    y_reach = max(float(np.max(np.abs(c.test_force))), float(np.max(np.abs(model), initial=0.0)))
    # A model far beyond its test would leave nothing to see of the test.
    y_reach = min(y_reach, 2.5 * float(np.max(np.abs(c.test_force))))
    x = _WIDTH / 2 * (1 + _REACH * c.displacement / x_reach)
    y = [_HEIGHT / 2 * (1 - _REACH * f / y_reach) for f in (c.test_force, model)]
    drift = f" = {100 * x_reach / c.height:.1f} %" if c.height > 0 else ""
    computed = f'<path class=m d="{svg_path(x[: c.rows], y[1])}"/>' if c.rows > 1 else ""
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img">'
        f"<title>{html.escape(row.specimen.name)}: model over test</title>"
        f'<path class=z d="M0,{_HEIGHT // 2} {_WIDTH},{_HEIGHT // 2}M{_WIDTH // 2},0 '
        f'{_WIDTH // 2},{_HEIGHT}"/><path class=t d="{svg_path(x, y[0])}"/>{computed}'
        f'<text x="{_WIDTH - 8}" y="{_HEIGHT // 2 + 52}" text-anchor="end">'
        f"{1e3 * x_reach:.0f} mm{drift}</text>"
        f'<text x="{_WIDTH // 2 + 12}" y="48">{1e-3 * y_reach:.0f} kN</text></svg>'
    )


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


_PAGE = """\
<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
:root{color-scheme:light dark}
body{font:14px/1.4 system-ui,sans-serif;margin:1.5rem;color:CanvasText;background:Canvas}
h1{font-size:1.2rem}table{border-collapse:collapse;margin:1rem 0}
td,th{padding:.15rem .7rem;text-align:right;border-bottom:1px solid #8884}
th:first-child{text-align:left}
small{color:#888}nav{display:flex;gap:1rem;flex-wrap:wrap;position:sticky;top:0;background:Canvas;
padding:.5rem 0;z-index:1}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(290px,1fr));gap:1rem}
figure{margin:0;padding:.6rem;border:1px solid #8884;border-radius:4px}
figure p{margin:.2rem 0 0}figcaption,figure p{font-size:12px}.error{color:#c33}
svg{width:100%;display:block}svg text{font-size:44px;fill:#888}
path{fill:none;vector-effect:non-scaling-stroke}.z{stroke:#8886;stroke-width:.7}
.t{stroke:#999;stroke-width:1.3}.m{stroke:CanvasText;stroke-width:1}
.key{align-self:center}.key i{font-style:normal;color:#999}
</style></head><body><h1>{title}</h1>{summary}
<nav><label>Sort <select id=sort><option value=table>as in the table</option>
<option value=nrmse selected>NRMSE, worst first</option>
<option value=best>NRMSE, best first</option>
<option value=peak>peak ratio</option><option value=energy>energy ratio</option>
<option value=axial>axial load ratio</option><option value=name>name</option></select></label>
<label>Failure <select id=mode><option value="">all</option>{options}</select></label>
<label>Name <input id=text type=search size=18></label>
<span class=key><i>gray: test</i>, dark: model</span><span id=count></span></nav>
<main id=cards>
{cards}
</main><script>
const main=document.getElementById("cards"),all=[...main.children];
const get=id=>document.getElementById(id);
function show(){
 const key=get("sort").value,mode=get("mode").value,text=get("text").value.toLowerCase();
 const number=(f,k)=>{const x=parseFloat(f.dataset[k]);return isNaN(x)?-1e9:x};
 const list=[...all];
 if(key==="name")list.sort((a,b)=>a.dataset.name.localeCompare(b.dataset.name));
 else if(key==="best")list.sort((a,b)=>number(a,"nrmse")-number(b,"nrmse"));
 else if(key!=="table")list.sort((a,b)=>number(b,key)-number(a,key));
 let n=0;
 for(const f of list){
  const on=(!mode||f.dataset.mode===mode)&&f.dataset.name.toLowerCase().includes(text);
  f.hidden=!on;n+=on;main.append(f);
 }
 get("count").textContent=n+" of "+all.length;
}
for(const id of["sort","mode","text"])get(id).addEventListener("input",show);
show();
</script></body></html>
"""
