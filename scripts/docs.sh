#!/usr/bin/env bash
# Builds the documentation: the pages (Sphinx) and, below them, the Fortran part (FORD); a warning or a dead
# link is an error.
#
#   bash scripts/docs.sh            docs/_build/html/index.html
#
# RBSDEM_LINKS=all looks at the links to other sites too.
RBSDEM_EXTRA=docs
. "$(dirname "${BASH_SOURCE[0]}")/build.sh"

cd "$root"
site=docs/_build/html
say "pages"
python -m sphinx -q -W --keep-going -b html docs "$site"
say "the Fortran part"
ford --output_dir "$root/$site/fortran" docs/ford.md >docs/_build/ford.log 2>&1 ||
    { cat docs/_build/ford.log >&2; fail "ford failed"; }
! grep -i warning docs/_build/ford.log || fail "ford warns; its messages are above"
say "links"
outside=()
[ "${RBSDEM_LINKS:-}" != all ] || outside=(--check-extern)
# Two steps from the first page: every link of every page, and those of the first one of the Fortran part, whose
# other 1700 pages take many minutes.
linkchecker --no-status --no-robots --recursion-level=2 "${outside[@]}" "$site/index.html" | tail -n 4
say "$site/index.html"
