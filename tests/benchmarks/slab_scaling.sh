#!/usr/bin/env bash
# Weak scaling of slabs: a bed that grows with the ranks, 1, 2 and 4 bays of 0.60 m on as many ranks with grains, each
# with one thread. Prints wall and processor seconds, and processor seconds per bay, which would stay the same if slabs
# cost nothing. Where there are fewer cores than ranks, the wall time says nothing; the processor time includes waiting.
#   tests/benchmarks/slab_scaling.sh [PROGRAM]
set -euo pipefail
program=$(realpath "${1:-build/release/bin/trackbed}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_WAIT_POLICY=passive
cd "$work"

scene() { # bays
  cat <<END
title = "$1 bays"
[grains]
material = { young_modulus = "0.2 GPa", poisson_ratio = 0.2, density = 2700 }
friction = 0.5
restitution = 0.4
rolling_friction = 0.1
[[grains.periodic]]
axis = "x"
lower = 0.0
upper = $(awk "BEGIN { print 0.6 * $1 }")
[[grain]]
position = [0.02, 0.021, 0.021]
radius = "19.5 mm"
velocity = [0.05, 0.02, -0.5]
repeat = [$((15 * $1)), 27, 9]
spacing = [0.04, 0.04, 0.04]
[[wall]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[wall]]
name = "side0"
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
[[wall]]
name = "side1"
plane = { point = [0, 1.08, 0], normal = [0, -1, 0] }
[[stage]]
name = "settle"
duration = "2 s"
measure = true
[[probe]]
name = "kinetic"
kind = "kinetic_energy"
[output]
interval = "1 s"
probe_interval = "20 ms"
END
}

printf '%5s %6s %8s %8s %10s %14s\n' bays ranks grains 'wall s' 'CPU s' 'CPU s per bay'
for bays in 1 2 4; do
  scene $bays > bays.toml
  TIMEFORMAT='%R %U %S'
  { time mpirun --bind-to none --oversubscribe -n $bays "$program" run bays.toml --threads 1 --overwrite > log.txt; } \
    2> time.txt || { cat log.txt time.txt; exit 1; }
  read -r wall user system < <(tail -n 1 time.txt)
  grains=$(grep -o '"grains": *[0-9]*' runs/bays/summary.json | grep -o '[0-9]*$')
  cpu=$(awk "BEGIN { print $user + $system }")
  printf '%5d %6d %8d %8.1f %10.1f %14.1f\n' $bays $bays "$grains" "$wall" "$cpu" "$(awk "BEGIN { print $cpu / $bays }")"
done
