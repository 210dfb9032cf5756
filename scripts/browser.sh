#!/usr/bin/env bash
# Installs Chromium and its driver (apt), with which the tests of the page are run, if that needs no password.
#
#   bash scripts/browser.sh
#
# It never fails: without a browser these tests are skipped with a reason.
without() { printf '%s\n' "-- no Chromium ($*); the tests of the page in a browser are skipped"; exit 0; }

command -v chromedriver >/dev/null 2>&1 && exit 0
command -v apt-get >/dev/null 2>&1 || without "this system has no apt-get"
if [ "$(id -u)" = 0 ]; then as_root=(env)
elif sudo -n true >/dev/null 2>&1; then as_root=(sudo -n env)
else without "as root: apt-get install chromium chromium-driver"
fi
"${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get update -qq >/dev/null 2>&1 || without "apt-get update failed"
"${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    chromium chromium-driver >/dev/null 2>&1 || without "apt-get install chromium chromium-driver failed"
