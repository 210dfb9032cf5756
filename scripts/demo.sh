#!/usr/bin/env bash
# Sets up what is missing, builds, and shows what rbsdem does: a building from its drawings to a report, then
# the four columns of the source paper beside their tests. Figures and report are in ./figures.
#
#   bash scripts/demo.sh [--peer DIR]
. "$(dirname "${BASH_SOURCE[0]}")/build.sh"

cd "$root"
export MPLBACKEND=Agg
say "a building: drawn, pushed, judged by two codes, shaken by eight records"
mkdir -p figures
(cd figures && "$venv/bin/python" ../examples/13-building/case.py)
say "four columns of laboratory tests: predicted from their drawings, then as in the source paper"
"$venv/bin/python" examples/01-paper-columns/run.py "$@"
