"""Works to cite for an analysis: those of its rules, methods and fitted relations, and rbsdem."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rbsdem import _core, _package
from rbsdem.model.frame import Frame, Structure

#: Where a work has appeared, by its kind; of articles with volume and pages.
_FIELDS = {"techreport": "institution", "inproceedings": "booktitle", "misc": "note"}
_ARTICLE = re.compile(r"(?P<journal>.*) (?P<volume>\d+), (?P<pages>\d+--\d+)")


def parts_of(structure: Structure, method: str) -> set[str]:
    """Return the parts of an analysis that works stand behind, as `data/references.csv` names them.

    Parameters
    ----------
    structure : Column or Frame
        The structure.
    method : str
        The method that solved it.
    """
    found = {"all", f"method:{method}"}
    for _, given in _core.groups(structure._groups()):
        if "rule" in given:
            found.add(f"rule:{given['rule']}")
    if isinstance(structure, Frame):
        found |= {f"rule:{spring.rule}" for spring in structure.parts.springs}
        for name in ("shear_drift", "failure_drift"):
            if any(getattr(kind, name) is not None for kind in structure.kinds.values()):
                found.add(name)
        drawn = any(kind.sections is not None for kind in structure.kinds.values())
    else:
        drawn = getattr(structure, "drawing", None) is not None
    return found | ({"drawn"} if drawn else set())


def bibtex(parts: Iterable[str]) -> str:
    """Return the works behind parts of analyses as BibTeX, in the order of their table."""
    wanted, entries = set(parts), []
    for row in _package.rows("references.csv"):
        if not wanted & set(row["of"].split()):
            continue
        fields = {name: row[name] for name in ("author", "title", "year")}
        article = _ARTICLE.fullmatch(row["source"])
        if article:
            fields |= article.groupdict()
        elif row["source"]:
            fields[_FIELDS[row["kind"]]] = row["source"]
        if row["key"] == "rbsdem":
            fields["version"] = _core.version()
        # Double braces keep the capitals of a title.
        fields["title"] = f"{{{fields['title']}}}"
        lines = [f"  {name} = {{{text}}}" for name, text in fields.items() if text]
        entries.append(f"@{row['kind']}{{{row['key']},\n" + ",\n".join(lines) + "\n}\n")
    return "\n".join(entries)
