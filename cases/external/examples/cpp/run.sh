#!/bin/sh
# Adapter: builds the solver against the force of the case, and runs it. Usage: run.sh CASE OUT
set -e
c++ -O2 -std=c++17 -I "$1" "$(dirname "$0")/solver.cpp" -o "$2/solver"
"$2/solver" "$1" "$2"
