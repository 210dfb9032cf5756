#!/usr/bin/env bash
# Sets up what is missing, builds, and runs every linter and every test.
#
#   bash scripts/test.sh
#
# A test that needs the full histories finds them through RBSDEM_PEER_DIR or in ../shared/peer; without
# them it is skipped with a reason.
RBSDEM_EXTRA=test
RBSDEM_WITH_VALGRIND=1
. "$(dirname "${BASH_SOURCE[0]}")/build.sh"

cd "$root"
say "linters"
ruff check .
ruff format --check -q .
fortitude check -q

say "Fortran tests, built as for use"
[ -e build/fortran/build.ninja ] || meson setup build/fortran >/dev/null
meson test -C build/fortran --quiet

say "Fortran tests with bounds checks and floating-point traps"
bash scripts/checked.sh

say "leaks, one run of each analysis"
bash scripts/memory.sh

say "Python tests, regression and fuzzing, with the checked executable too"
MPLBACKEND=Agg python -m pytest -q
