# shellcheck shell=bash
# What gpu_check.sh reads out of other programs' words; tested by tests/gpu_check_parts_test.sh.

# PATTERN FILE…: lines that have it, in all of the files that exist.
count() { { grep -h -c "$1" "${@:2}" 2>/dev/null || true; } | awk '{ n += $1 } END { print n + 0 }'; }

# SUMMARY.json: the shares of the wall time, one after the other; nothing where there are none.
wall_shares() { tr -d ' \n' <"$1" | sed -n 's/.*"wall_share":{\([^}]*\)}.*/\1/p' | tr -d '"' | sed 's/,/, /g'; }

# SUMMARY.json, or nothing: a row of the table of targets. Less than a tenth of the wall time goes into the exchange.
exchange_row() {
  local share='' verdict='not measured'
  if [[ -n ${1:-} && -f $1 ]]; then share=$(wall_shares "$1" | sed -n 's/.*exchange:\([-+.0-9eE]*\).*/\1/p'); fi
  if [[ -n $share ]]; then
    verdict=$(awk -v s="$share" 'BEGIN { print (s < 0.1 ? "held" : "**not held**") }')
    share=$(awk -v s="$share" 'BEGIN { printf "%.1f %%", 100 * s }')
  fi
  printf '| one sleeper on clumps, coupled | < 10 %% of the wall time in the exchange | %s | %s |\n' "${share:-–}" "$verdict"
}

# LOG: what a tool of compute-sanitizer says at its ends.
sanitizer_summary() { grep -E 'ERROR SUMMARY|RACECHECK SUMMARY' "$1" | sed 's/^=* *//' | sort | uniq -c | sed 's/^ *1 //; s/^ *\([0-9][0-9]*\) /\1 × /' | tr '\n' ';' || true; }

# FOLDER: the scenes in it that have grains.
scenes_with_grains() {
  local scene
  for scene in "$1"/*.toml; do
    if has_grains "$scene"; then printf '%s\n' "$scene"; fi
  done
}
# SCENE: whether it, or what it includes, speaks of grains.
has_grains() {
  local included
  grep -q '^\[grains\]' "$1" && return 0
  included=$(sed -n 's/^include *= *"\(.*\)".*/\1/p' "$1" | head -n 1)
  [[ -n $included && -f $(dirname -- "$1")/$included ]] && has_grains "$(dirname -- "$1")/$included"
}
