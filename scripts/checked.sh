#!/usr/bin/env bash
# Fortran tests with bounds checks and floating-point traps, in a build of their own.
#
#   bash scripts/checked.sh [folder of the build]        default: build/checked
#
# The executable of this build is <folder>/src/app/rbsdem.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/checked}
# Alone, it sets up what the build needs; scripts/test.sh has done that already.
if ! command -v meson >/dev/null 2>&1; then
    . "$root/scripts/setup.sh"
fi

[ -e "$build/build.ninja" ] || meson setup "$build" "$root" -Dchecked=true >/dev/null
meson test -C "$build" --quiet --print-errorlogs
