#!/usr/bin/env bash
# Leaks and invalid reads: valgrind on one run of each analysis, and with --all on every suite of unit
# tests.
#
#   bash scripts/memory.sh [--all] [folder of the build]         default: build/memory
#
# An executable must also end with the exit code that its input calls for.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
all=0
if [ "${1:-}" = --all ]; then
    all=1
    shift
fi
build=${1:-$root/build/memory}
if ! command -v meson >/dev/null 2>&1 || ! command -v valgrind >/dev/null 2>&1; then
    RBSDEM_WITH_VALGRIND=1 . "$root/scripts/setup.sh"
fi

# Optimised as for use, with the lines of the source.
[ -e "$build/build.ninja" ] || meson setup "$build" "$root" --buildtype=debugoptimized >/dev/null
meson compile -C "$build" >/dev/null

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# watch NAME EXPECTED COMMAND...: run under valgrind, compare the exit code.
watch() {
    local name=$1 expected=$2 status=0
    shift 2
    valgrind --quiet --leak-check=full --errors-for-leak-kinds=definite,indirect,possible \
        --show-leak-kinds=definite,indirect,possible --track-origins=yes --error-exitcode=99 \
        "$@" >"$work/out" 2>"$work/err" || status=$?
    if [ "$status" = "$expected" ]; then
        printf 'ok    %s\n' "$name"
    else
        printf 'FAIL  %s: exit code %s, expected %s (99: valgrind)\n' "$name" "$status" "$expected"
        head -n 60 "$work/err"
        failed=1
    fi
}

# case_file NAME < namelist groups that follow the springs of a real column.
case_file() {
    {
        printf '%s\n' \
            "&shear rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6 /" \
            "&flexure rule = 'takeda', k_c = 2.5428e8, d_c = 3.1891e-4, k_y = 6.2937e7," \
            "         d_y = 2.7183e-3, k_u = 7.5772e6, b0 = 0.4, b1 = 0.22 /"
        cat
    } >"$work/$1.nml"
}

case_file static_small <<'NML'
&column height = 1.6, mass = 614.4 /
&loading drive = 'force', unit = 'kN', amplitudes = 50, 100, 150, cycles = 2 /
NML
case_file static_pdelta <<'NML'
&column n = 4, height = 1.6, mass = 614.4, kinematics = 'pdelta',
   axial_load = 744e3, self_weight = .true. /
&loading drive = 'displacement', amplitudes = 0.0025, 0.01, 0.03, cycles = 2, 1, 2 /
NML
case_file dynamic_chain <<'NML'
&column n = 4, height = 1.6, mass = 614.4, kinematics = 'pdelta', axial_load = 744e3 /
&damping mass = 1.0 /
&loading drive = 'ground_acceleration', file = 'ground.csv' /
&loading drive = 'force', unit = 'kN', amplitudes = 20, period = 0.3 /
&analysis method = 'rk4' /
&output every = 3 /
NML
printf '%s\n' 'time_s,acceleration_g' '0.0,0.0' '0.1,0.5' '0.2,-0.7' '0.3,0.0' >"$work/ground.csv"
case_file dynamic_finite <<'NML'
&column height = 1.6, mass = 614.4, kinematics = 'finite' /
&damping stiffness = 1e-6 /
&loading drive = 'force', unit = 'kN', amplitudes = 150, period = 0.2 /
&analysis method = 'rk4', dt = 1e-4 /
NML
# Springs of its own: layers that refer to springs, other units, values in the text.
cat >"$work/layers.nml" <<'NML'
&units force = 'kN', length = 'mm' /
&column n = 3, height = 1600, mass = 614.4, kinematics = 'pdelta', axial_load = 700 /
&shear rule = 'elastic', k = 400 /
&flexure joint = 1, 3, rule = 'layered' /
&flexure rule = 'elastic', k = 2e8 /
&layer_spring id = 1, rule = 'concrete', k = 4000, f_peak = 1200, d_peak = 0.6, k_soft = 80 /
&layer_spring id = 2, rule = 'steel', k = 800, f_y = 700, k_post = 8, r0 = 8 /
&layers joint = 1, 3, y = -150, -50, 50, 150, -160, 160, spring = 1, 1, 1, 1, 2, 2 /
&loading drive = 'displacement', values = 0, 8, -8, 16, -16, 0 /
NML
case_file capacity <<'NML'
&column height = 1.6, mass = 614.4, kinematics = 'pdelta', axial_load = 8e6 /
&loading drive = 'force', unit = 'kN', amplitudes = 200 /
NML
case_file refused <<'NML'
&column n = 0, height = -1.6, kinematics = 'pdalta' /
&loading drive = 'force', unit = 'kN', amplitudes = 200, sycles = 3 /
NML

# The form of the list depends on the version of meson; the suite is its last word.
suites=
[ "$all" = 0 ] || suites=$(meson test -C "$build" --list --suite fortran 2>/dev/null | sed -n 's/.*[:/] *\([a-z_0-9]*\)$/\1/p')
[ "$all" = 0 ] || [ -n "$suites" ] || { echo 'memory: meson lists no tests' >&2; exit 1; }
for suite in $suites; do
    watch "unit tests: $suite" 0 "$build/tests/fortran/unit_tests" "$suite"
done

rbsdem="$build/src/app/rbsdem"
for name in static_small static_pdelta dynamic_chain dynamic_finite layers; do
    watch "rbsdem run $name" 0 "$rbsdem" run "$work/$name.nml" --output "$work/$name.csv"
done
watch 'rbsdem run, beyond the capacity' 1 "$rbsdem" run "$work/capacity.nml" --output "$work/capacity.csv"
watch 'rbsdem modes' 0 "$rbsdem" modes "$work/static_pdelta.nml"
watch 'rbsdem check' 0 "$rbsdem" check "$work/dynamic_chain.nml"
watch 'rbsdem check, bad input' 2 "$rbsdem" check "$work/refused.nml"
watch 'rbsdem keys' 0 "$rbsdem" keys --json
watch 'rbsdem run, no such file' 2 "$rbsdem" run "$work/nowhere.nml"
exit "$failed"
