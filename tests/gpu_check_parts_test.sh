#!/usr/bin/env bash
# What gpu-check reads and refuses, as far as no GPU is needed for it.
set -euo pipefail

tests=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
# shellcheck source=gpu_check_parts.sh
. "$tests/gpu_check_parts.sh"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
wrong=0
expect() { # NAME FOUND EXPECTED
  [[ $2 == "$3" ]] && return
  printf '%s:\n  found    %s\n  expected %s\n' "$1" "$2" "$3" >&2
  wrong=1
}

# A tenth is too much, just below it is not; without a summary nothing is measured.
row='| one sleeper on clumps, coupled | < 10 % of the wall time in the exchange |'
for share in 0.0999:'10.0 % | held' 0.1:'10.0 % | **not held**' 1.9e-2:'1.9 % | held' 0.35:'35.0 % | **not held**'; do
  printf '{\n "wall_s": 3,\n "wall_share": {\n  "dem": 0.4,\n  "exchange": %s,\n  "fem": 0.5\n }\n}\n' "${share%%:*}" >"$scratch/summary.json"
  expect "exchange of ${share%%:*}" "$(exchange_row "$scratch/summary.json")" "$row ${share#*:} |"
done
expect 'all shares' "$(wall_shares "$scratch/summary.json")" 'dem:0.4, exchange:0.35, fem:0.5'
expect 'no summary' "$(exchange_row "$scratch/none.json")" "$row – | not measured |"
printf '{ "wall_share": { "dem": 1.0 } }' >"$scratch/summary.json"
expect 'a run without exchange' "$(exchange_row "$scratch/summary.json")" "$row – | not measured |"

printf '[       OK ] A.a (1 ms)\n[       OK ] A.b (1 ms)\n' >"$scratch/0.log"
printf '[       OK ] A.c (1 ms)\n' >"$scratch/1.log"
expect 'count' "$(count '^\[       OK \]' "$scratch"/*.log)" 3
expect 'count of none' "$(count 'FAILED' "$scratch"/*.log)" 0

printf '========= ERROR SUMMARY: 0 errors\nx\n========= ERROR SUMMARY: 0 errors\n========= RACECHECK SUMMARY: 1 hazard\n' >"$scratch/tool.log"
expect 'sanitizer' "$(sanitizer_summary "$scratch/tool.log")" '2 × ERROR SUMMARY: 0 errors;RACECHECK SUMMARY: 1 hazard;'

mkdir "$scratch/scenes"
printf '[grains]\n' >"$scratch/grains.toml"
printf 'title = "a"\ninclude = "../grains.toml"\n' >"$scratch/scenes/a.toml"
printf '[[body]]\n' >"$scratch/scenes/b.toml"
printf '[grains]\n' >"$scratch/scenes/c.toml"
expect 'scenes with grains' "$(scenes_with_grains "$scratch/scenes" | xargs -n 1 basename | tr '\n' ' ')" 'a.toml c.toml '

# The command's own words.
help=$("$tests/gpu_check.sh" --help) || expect '--help' "status $?" 'status 0'
for word in --minutes --rehearse docs/gpu.md GOOGLETEST; do
  [[ $help == *$word* ]] || expect "--help: $word" "$help" "… $word …"
done
status=0
said=$("$tests/gpu_check.sh" --fast 2>&1) || status=$?
expect 'an unknown option' "$status $(head -n 1 <<<"$said")" '2 gpu-check: --fast: no such option; --help names them'
status=0
said=$("$tests/gpu_check.sh" --minutes soon 2>&1) || status=$?
expect 'no number' "$status $(head -n 1 <<<"$said")" '2 gpu-check: --minutes soon: must be a whole number of minutes'
exit $wrong
