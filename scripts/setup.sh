#!/usr/bin/env bash
# Sets up what the build needs and is not there yet: system packages (apt) and a virtual environment.
#
#   . scripts/setup.sh              sourced by demo.sh and test.sh
#   bash scripts/setup.sh           the same, alone
#
# RBSDEM_VENV picks another folder than .venv; PYTHON another interpreter than python3.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=${RBSDEM_VENV:-$root/.venv}
python=${PYTHON:-python3}

say() { printf '%s\n' "-- $*"; }
fail() { printf 'setup: %s\n' "$*" >&2; exit 1; }

command -v "$python" >/dev/null 2>&1 ||
    fail "$python not found; install Python 3.10 or newer (apt-get install python3), or set PYTHON"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' ||
    fail "$python is $("$python" -V 2>&1); Python 3.10 or newer is needed (set PYTHON to one)"

# What is missing, by what it is needed for, not by package lists: a machine may have it from elsewhere.
missing=()
command -v gfortran >/dev/null 2>&1 || missing+=(gfortran)
command -v cc >/dev/null 2>&1 || missing+=(gcc libc6-dev)
command -v pkg-config >/dev/null 2>&1 || missing+=(pkg-config)
has_library() {
    { command -v ldconfig >/dev/null 2>&1 && ldconfig -p || /sbin/ldconfig -p; } 2>/dev/null |
        grep -q "lib$1\.so " || [ -n "$(ls /usr/lib/*/lib"$1".so /usr/lib/lib"$1".so 2>/dev/null)" ]
}
has_library lapack || missing+=(liblapack-dev)
has_library blas || missing+=(libblas-dev)
"$python" - <<'PY' || missing+=(python3-dev)
import os, sys, sysconfig
sys.exit(not os.path.exists(os.path.join(sysconfig.get_paths()["include"], "Python.h")))
PY
"$python" -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3-venv)
[ "${RBSDEM_WITH_VALGRIND:-0}" = 0 ] || command -v valgrind >/dev/null 2>&1 || missing+=(valgrind)

if [ "${#missing[@]}" -gt 0 ]; then
    say "installing ${missing[*]}"
    command -v apt-get >/dev/null 2>&1 ||
        fail "missing: ${missing[*]} (Debian names); this system has no apt-get, install them and run again"
    if [ "$(id -u)" = 0 ]; then as_root=(env)
    elif command -v sudo >/dev/null 2>&1; then as_root=(sudo env)
    else fail "missing: ${missing[*]}; run as root or with sudo: apt-get install ${missing[*]}"
    fi
    "${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get update -qq >/dev/null ||
        fail "apt-get update failed; missing: ${missing[*]}"
    "${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        "${missing[@]}" >/dev/null || fail "apt-get install ${missing[*]} failed"
fi

# A browser is wanted by some tests and not needed; it comes while the rest goes on. Wait for $browser.
browser=
if [ "${RBSDEM_WITH_BROWSER:-0}" != 0 ]; then
    bash "$root/scripts/browser.sh" &
    browser=$!
fi

if [ ! -x "$venv/bin/python" ]; then
    say "making the virtual environment ${venv#"$root"/}"
    "$python" -m venv "$venv" || fail "$python -m venv failed; apt-get install python3-venv"
fi
# The lists of pyproject.toml are the only ones: requirements and the extra that the caller wants.
stamp="$venv/.rbsdem-${RBSDEM_EXTRA:-plain}"
if [ ! -e "$stamp" ] || [ "$root/pyproject.toml" -nt "$stamp" ]; then
    say "installing Python packages${RBSDEM_EXTRA:+ ($RBSDEM_EXTRA)}"
    # The pip of older distributions cannot pass settings to the build.
    { echo "pip>=23.1"; "$venv/bin/python" "$root/scripts/requirements.py" ${RBSDEM_EXTRA:+"$RBSDEM_EXTRA"}; } |
        "$venv/bin/python" -m pip install -q --disable-pip-version-check -r /dev/stdin ||
        fail "pip could not install the packages named in pyproject.toml"
    touch "$stamp"
fi
PATH="$venv/bin:$PATH"
export PATH
