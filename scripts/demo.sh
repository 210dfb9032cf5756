#!/usr/bin/env bash
# Sets up what is missing, builds, and runs the main job: the four columns of the paper, predicted
# from their drawings, and with the springs of the paper, over their tests.
#
#   bash scripts/demo.sh [--peer DIR] [--out DIR] [--no-plot]
. "$(dirname "${BASH_SOURCE[0]}")/build.sh"

cd "$root"
MPLBACKEND=Agg "$venv/bin/python" examples/01-paper-columns/run.py "$@"
