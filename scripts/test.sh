#!/usr/bin/env bash
# Sets up what is missing, builds, and runs every linter and every test.
#
#   bash scripts/test.sh
#
# A test that needs the full histories finds them through RBSDEM_PEER_DIR or in ../shared/peer; without
# them it is skipped with a reason.
RBSDEM_EXTRA=test
RBSDEM_WITH_VALGRIND=1
RBSDEM_WITH_BROWSER=1
. "$(dirname "${BASH_SOURCE[0]}")/build.sh"

cd "$root"
say "linters"
ruff check .
ruff format --check -q .
fortitude check -q
check-jsonschema -q --builtin-schema vendor.github-workflows .github/workflows/*.yml

say "the Fortran part alone can be set up"
[ -e build/fortran/build.ninja ] || meson setup build/fortran >/dev/null

# One build serves the package, its tests and these.
say "Fortran tests, optimised as for use"
meson test -C build/python --quiet --print-errorlogs

say "leaks, one run of each analysis"
bash scripts/memory.sh build/python

say "Python tests, fuzzing, regression; examples of the documentation"
export MPLBACKEND=Agg
wait "$browser"
python -m pytest -q -n 2 --dist worksteal
python scripts/check_docs.py

say "editable install"
install_rbsdem() { python -m pip install -q --disable-pip-version-check --no-build-isolation --no-deps \
    -Cbuild-dir="$root/build/python" "$@"; }
install_rbsdem --editable .
(cd / && rbsdem --version && python -c 'import rbsdem; rbsdem.paper_columns()')
install_rbsdem .

# The tests in Python that bring numbers of all kinds to Fortran; the others see nothing new there.
say "what calls Fortran once more, with bounds checks and floating-point traps"
crossing=(tests/regression)
for name in fuzz extremes_columns extremes_input extremes_rotations extremes_scales extremes_springs \
    extremes_steps extremes_time static dynamics springs springs_capped layered layered_input interaction \
    physics column ensembles motions strains doors base_forces section; do
    crossing+=("tests/python/test_$name.py")
done
python -m pip install -q --disable-pip-version-check --no-build-isolation --no-deps --upgrade \
    --target build/checked-site -Cbuild-dir=build/checked -Csetup-args=-Dchecked=true .
meson test -C build/checked --quiet --print-errorlogs
PYTHONPATH="$root/build/checked-site" python -m pytest -q -n 2 --dist worksteal "${crossing[@]}"
