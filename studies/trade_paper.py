"""What accuracy costs for the four columns of the paper: the tables and figures of trade.md.

    python studies/trade_paper.py [--budget SECONDS]

Three scenes for each column: drifts of a cyclic test, static with P-Delta; the reversal forces of
its test, slowly, as in figure 3 of the paper (equation 4: finite rotations, no axial load); the
ground motion of examples/03-ground-motion with the mass that the axial load is the weight of.
Prints Markdown and writes trade_slow.png and trade_ground.png to docs.
"""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import rbsdem
from rbsdem import plot
from rbsdem.methods.ladder import MethodRun
from rbsdem.methods.study import MethodStudy, compare_methods, seconds_text
from rbsdem.peer import shipped_reversals

ROOT = Path(__file__).resolve().parents[1]
MOTION = ROOT / "examples" / "03-ground-motion" / "ground.csv"
GRAVITY = 9.80665
DRIFTS = (0.0025, 0.005, 0.01, 0.02, 0.03)
TOLERANCES = (1e-2, 1e-3, 1e-5, 1e-7)

# A leg between two reversals is half a cosine of this many rows, each loaded in this time [s], as
# in examples/01-paper-columns.
ROWS, ROW_TIME = 30, 0.1


def static(key: str, budget: float) -> MethodStudy:
    """Return the study of the cyclic drifts."""
    column = rbsdem.peer.paper_columns("pdelta")[key]
    path = column.height * rbsdem.protocol(DRIFTS, cycles=2)
    return compare_methods(column, displacement=path, budget=budget)


def slow(key: str, budget: float) -> MethodStudy:
    """Return the study of the test's reversal forces, equation 4 of the paper."""
    column = rbsdem.peer.paper_columns("finite", axial_load=0.0)[key]
    force = shipped_reversals(key).force
    leg = 0.5 - 0.5 * np.cos(np.pi * np.arange(ROWS) / ROWS)
    path = np.append((force[:-1, None] + np.outer(np.diff(force), leg)).ravel(), force[-1])
    time = ROW_TIME * np.arange(path.size)
    return compare_methods(column, time, force=path, setting={"method": "rk4"}, budget=budget)


def ground(key: str, budget: float) -> MethodStudy:
    """Return the study of the ground motion, with a storey on top."""
    weight = rbsdem.peer.paper_columns()[key].axial_load
    column = rbsdem.peer.paper_columns("pdelta", top_mass=weight / GRAVITY)[key]
    time, acceleration = np.loadtxt(MOTION, delimiter=",", skiprows=2, unpack=True)
    motion = GRAVITY * acceleration
    own = {"method": "rk4"}
    return compare_methods(column, time, ground_acceleration=motion, setting=own, budget=budget)


def chain(budget: float) -> MethodStudy:
    """Return the study of the stiff chain of three bodies of the example."""
    case = rbsdem.read_case(MOTION.with_name("case.nml"))
    return compare_methods(
        case.column,
        case.time,
        ground_acceleration=case.ground_acceleration,
        setting={"method": case.method},
        budget=budget,
    )


SCENES = {
    "static": ("Cyclic drifts, static, P-Delta", static),
    "slow": ("Slow force, finite rotations", slow),
    "ground": ("Ground motion with a storey, P-Delta", ground),
}


def cell(row: MethodRun | None, given: str) -> str:
    """Return a setting and its time; the level of kinematics, if it is below the column's."""
    if row is None:
        return "none"
    level = "" if row.setting.kinematics == given else f" {row.setting.kinematics}"
    value = row.setting.value.replace("tolerance = ", "").replace("dt = ", "")
    return f"{row.setting.name} {value}{level}, {seconds_text(row.seconds)}"


def settings_table(found: dict[str, MethodStudy]) -> None:
    """Print reference and cheapest settings of one scene."""
    print("| column | digits of the reference |", end="")
    print(" | ".join(f" within {tolerance:g}" for tolerance in TOLERANCES), "|")
    print("| --- | --- |" + " --- |" * len(TOLERANCES))
    for key, one in found.items():
        given = one.rows[0].setting.kinematics
        cells = [cell(one.cheapest(tolerance), given) for tolerance in TOLERANCES]
        print(f"| {name(key)} | {one.reference.digits:.1f} | {' | '.join(cells)} |")
    print()


def physics_table(found: dict[str, MethodStudy]) -> None:
    """Print the effects of the parts of the model: peak, base moment, energy in %."""
    print(f"| change | {' | '.join(name(key) for key in found)} |")
    print("| --- |" + " --- |" * len(found))
    for effects in zip(*(one.physics.effects for one in found.values()), strict=True):
        cells = []
        for effect in effects:
            changes = (effect.peak, effect.moment, effect.energy)
            # Zero has no sign.
            text = ", ".join(f"{round(100 * change, 1) + 0.0:+.1f}" for change in changes)
            text = text.replace("+0.0", "0")
            cells.append(text if effect.matters is not None else effect.status)
        print(f"| {effects[0].part} | {' | '.join(cells)} |")
    print()


# Settings that the page shows; all are in the figures. Steps of rk4 differ from column to column:
# the largest stable one, its half, ...
SHOWN = {
    "static": ("reversals only", "points as given", "increments in 4"),
    "rk4": ("step chosen", "largest step", "largest step / 4", "largest step / 16"),
    "rk4, located": ("largest step / 4", "largest step / 16", "largest step / 64"),
    "rk45": ("tolerance = 1e-04", "tolerance = 1e-06", "tolerance = 1e-08", "tolerance = 1e-10"),
    "auto": ("step chosen",),
    "newmark": ("dt = 0.02 s", "dt = 0.005 s", "dt = 0.00125 s"),
    "hht": ("dt = 0.02 s", "dt = 0.005 s"),
    "generalised_alpha": ("dt = 0.02 s", "dt = 0.005 s", "dt = 0.00125 s"),
}


def same_settings(found: dict[str, MethodStudy]) -> dict[tuple[str, str], list[MethodRun]]:
    """Return the rows of each setting, one for each column, at the columns' level of kinematics."""
    families: dict[tuple[str, str], list[MethodRun]] = {}
    for one in found.values():
        level = one.rows[0].setting.kinematics
        rung: dict[str, int] = {}
        for row in one.rows:
            if row.setting.kinematics != level or row.status != "completed":
                continue
            value = row.setting.value
            if row.setting.method == "rk4" and not row.setting.own:
                place = rung[row.setting.name] = rung.get(row.setting.name, -1) + 1
                value = f"largest step / {2**place}" if place else "largest step"
            families.setdefault((row.setting.name, value), []).append(row)
    return families


def costs_table(families: dict[tuple[str, str], list[MethodRun]]) -> None:
    """Print wall times and errors of settings, least and largest of the four columns."""
    print("| method | setting | wall time | error |")
    print("| --- | --- | --- | --- |")
    for (method, value), rows in families.items():
        if value in SHOWN.get(method, ()):
            print(f"| {method} | {value}{steps(rows, value)} | {times(rows)} | {errors(rows)} |")
    print()


def sentences(title: str, families: dict[tuple[str, str], list[MethodRun]]) -> None:
    """Print a summary in words."""
    print(f"{title}:")
    for (method, value), rows in families.items():
        if value in SHOWN.get(method, ()):
            print(
                f"- {method} with {value}{steps(rows, value)} costs {times(rows)} and errs by "
                f"{errors(rows)}"
            )
    print()


def times(rows: list[MethodRun]) -> str:
    """Return the least and the largest time."""
    return span([row.seconds for row in rows], seconds_text)


def errors(rows: list[MethodRun]) -> str:
    """Return the least and the largest error."""
    return span([row.error for row in rows], lambda x: f"{x:.0e}" if x > 1e-12 else "round-off")


def steps(rows: list[MethodRun], value: str) -> str:
    """Return the steps that differ from column to column."""
    given = [1e3 * row.setting.dt for row in rows if row.setting.dt]
    return f" ({span(given, lambda x: f'{x:.2g}')} ms)" if value.startswith("largest") else ""


def span(values: list[float], text: Callable[[float], str]) -> str:
    """Return the least and the largest value."""
    low, high = text(min(values)), text(max(values))
    return low if low == high else f"{low} to {high}"


def name(key: str) -> str:
    """Return the name of a specimen."""
    return rbsdem.peer.paper_sections()[key].specimen if key in rbsdem.peer.paper_columns() else key


def picture(found: dict[str, MethodStudy], path: Path) -> None:
    """Draw the four columns of one scene."""
    from matplotlib.figure import Figure  # noqa: PLC0415

    with plot.style():
        figure = Figure(figsize=(6.9, 6.2), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True, sharey=True).ravel()
        for letter, ax, (key, one) in zip("abcd", panels, found.items(), strict=True):
            plot.methods(one, ax=ax)
            ax.get_legend().remove()
            ax.set_title(f"({letter}) {name(key)}", loc="left")
            ax.label_outer()
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=7.5)
        figure.savefig(path, dpi=110)


def main() -> None:
    """Measure, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--budget", type=float, default=20.0, help="seconds for each of 12 cases")
    given = parser.parse_args()
    print(
        f"{platform.machine()}, Python {platform.python_version()}, rbsdem {rbsdem.__version__}\n"
    )
    words = []
    for scene, (title, make) in SCENES.items():
        found = {}
        for key in rbsdem.peer.paper_columns():
            found[key] = make(key, given.budget)
            print(f"{title}, {name(key)}: {found[key].seconds:.0f} s", file=sys.stderr)
        print(f"### {title}\n")
        for key, one in found.items():
            reference = one.reference
            print(f"- {name(key)}: {reference.first} against {reference.second}")
            for text in filter(None, (reference.warning, *one.warnings)):
                print(f"  ({text})")
        print()
        families = same_settings(found)
        settings_table(found)
        costs_table(families)
        words.append((title, families))
        physics_table(found)
        if scene != "static":
            picture(found, ROOT / "docs" / f"trade_{scene}.png")
    title, found = "Three bodies of examples/03-ground-motion", {"chain": chain(3 * given.budget)}
    print(f"### {title}\n")
    settings_table(found)
    costs_table(same_settings(found))
    words.append((title, same_settings(found)))
    for title, families in words:
        sentences(title, families)


if __name__ == "__main__":
    main()
