#!/usr/bin/env bash
# Builds and installs rbsdem into the virtual environment, extension and executable. Sourced.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

say "building rbsdem"
log=$(mktemp)
if ! "$venv/bin/python" -m pip install -q --disable-pip-version-check --no-build-isolation --no-deps \
    -Cbuild-dir="$root/build/python" "$root" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    fail "the build failed; the compiler's messages are above"
fi
rm -f "$log"
