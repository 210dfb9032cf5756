#!/usr/bin/env bash
# Sets up what is missing, builds, and runs every linter and every test: five to nine minutes on two cores, and
# two more the first time. Each step says what it does; the dots are those of pytest.
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
# What goes on behind the rest, where a core is free; what it says comes when the rest needs it.
behind() {
    local name=$1
    shift
    (renice -n 10 -p "$BASHPID" >/dev/null && "$@") >"build/$name.log" 2>&1 &
}
result_of() {
    local status=0
    wait "$1" || status=$?
    cat "build/$2.log"
    return "$status"
}
trap 'jobs -p | xargs -r kill 2>/dev/null' EXIT
install_rbsdem() { python -m pip install -q --disable-pip-version-check --no-build-isolation --no-deps "$@"; }
build_with_checks() {
    install_rbsdem --upgrade --target build/checked-site -Cbuild-dir=build/checked -Csetup-args=-Dchecked=true . &&
        meson compile -C build/checked >/dev/null
}
lint() {
    ruff check . && ruff format --check -q . && mypy && lint-imports --no-logo && fortitude check -q &&
        check-jsonschema -q --builtin-schema vendor.github-workflows .github/workflows/*.yml
}

say "linters, and the build with checks, behind the Fortran tests"
behind linters lint
linters=$!
behind checked build_with_checks
checks=$!

say "the Fortran part alone can be set up"
[ -e build/fortran/build.ninja ] || meson setup build/fortran >/dev/null

# One build serves the package, its tests and these.
say "Fortran tests, optimised as for use"
meson test -C build/python --quiet --print-errorlogs

behind memory bash scripts/memory.sh build/python
leaks=$!
say "linters"
result_of "$linters" linters

say "Python tests, fuzzing, regression"
export MPLBACKEND=Agg
wait "$browser"
behind docs python scripts/check_docs.py
docs=$!
python -m pytest -q -n 2 --dist worksteal

# Round-off must not choose the way of a path. Another kernel of OpenBLAS, if that is the LAPACK, has other sums.
module=$(python -c 'import rbsdem._rbsdem as module; print(module.__file__)')
if grep -q -m1 avx2 /proc/cpuinfo && ldd "$module" | awk '/blas|lapack/ {print $3}' | xargs readlink -f | grep -q openblas; then
    kernel=$(grep -q -m1 avx512f /proc/cpuinfo && echo Haswell || echo Prescott)
    say "paths through corners once more, with the kernel $kernel of OpenBLAS"
    RBSDEM_CASES=0.5 OPENBLAS_CORETYPE=$kernel python -m pytest -q -n 2 tests/python/test_softening.py \
        tests/python/test_invariants_frames.py -k "softening or mirror or order or bit or path or corner"
fi

say "examples of the documentation"
result_of "$docs" docs
say "leaks, one run of each analysis"
result_of "$leaks" memory

say "editable install"
install_rbsdem -Cbuild-dir="$root/build/python" --editable .
(cd / && rbsdem --version && python -c 'import rbsdem; rbsdem.peer.paper_columns()')
install_rbsdem -Cbuild-dir="$root/build/python" .

# The tests in Python that bring numbers of all kinds to Fortran; the others see nothing new there. Of random
# cases a fifth, as they go the same ways.
say "what calls Fortran once more, with bounds checks and floating-point traps"
crossing=(tests/regression)
for name in fuzz extremes_columns extremes_input extremes_rotations extremes_springs \
    extremes_steps extremes_time static dynamics events implicit modes initial springs_capped \
    layered interaction physics column ensembles invariants invariants_frames plans strains doors \
    base_forces section messages; do
    crossing+=("tests/python/test_$name.py")
done
result_of "$checks" checked
meson test -C build/checked --quiet --print-errorlogs
RBSDEM_CASES=0.2 PYTHONPATH="$root/build/checked-site" python -m pytest -q -n 2 --dist worksteal "${crossing[@]}"
