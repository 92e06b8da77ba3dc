#!/usr/bin/env bash
# All that a GPU is needed for, in one go, and docs/gpu.md of what it found: the tests of the grains on CUDA, CUDA against
# the processor, compute-sanitizer, benchmarks, one coupled run. Needs no network. Where libraries are missing the grains
# alone are built. A step that fails or runs out of time is a line of the table.
#   ./trackbed gpu-check [--minutes N]   stops starting steps after N (8) minutes, the build included; writes docs/gpu.md;
#                                        exit status 0: all passed, 1: some step did not, 2: no GPU to use
#   ./trackbed gpu-check --rehearse      the same steps on the processor, small; writes build/rehearsal/check/gpu.md
#   ./trackbed gpu-check --help          this
# GOOGLETEST=FOLDER: GoogleTest's source, where the library is not installed.
set -euo pipefail

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
# shellcheck source=gpu_check_parts.sh
. "$root/tests/gpu_check_parts.sh"
say() { printf 'gpu-check: %s\n' "$*" >&2; }
refuse() {
  say "$1"
  say "nothing was run, docs/gpu.md is as it was"
  exit 2
}

backend=cuda
build=$root/build/gpu
page=$root/docs/gpu.md
minutes=8
while (($#)); do
  case $1 in
    --rehearse)
      backend=omp
      build=$root/build/rehearsal
      page=$build/check/gpu.md
      ;;
    --minutes)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || refuse "--minutes ${2:-}: must be a whole number of minutes"
      minutes=$2
      shift
      ;;
    -h | --help)
      sed -n '2,/^set/{ /^set/d; s/^# \{0,1\}//; p }' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    *) refuse "$1: no such option; --help names them" ;;
  esac
  shift
done
end=$(($(date +%s) + 60 * minutes))
seconds() { # LIMIT: so many seconds, or what is left of all
  local left=$((end - $(date +%s)))
  echo $((left < $1 ? left : $1))
}

logs=$build/check

# ---- is there a device, and a compiler for it
nvcc=$(PATH=$PATH:${CUDA_HOME:-/usr/local/cuda}/bin:/usr/local/cuda/bin command -v nvcc || true)
architecture=() # of this machine's GPU; not known: the default ones
if [[ $backend == cuda ]]; then
  export PATH=$PATH:/usr/local/nvidia/bin
  if ! command -v nvidia-smi >/dev/null && [[ ! -e /dev/nvidiactl ]]; then
    refuse "no GPU to use: no NVIDIA driver on this machine (neither nvidia-smi nor /dev/nvidiactl)"
  fi
  if command -v nvidia-smi >/dev/null; then
    listed=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>&1) ||
      refuse "no GPU to use: the driver answers: $(head -n 1 <<<"$listed")"
    [[ -n $listed ]] || refuse "no GPU to use: the driver knows no device"
    found=$(head -n 1 <<<"$listed" | tr -d '. ')
    [[ ! $found =~ ^[0-9]+$ ]] || architecture=("-DTRACKBED_CUDA_ARCHITECTURES=$found")
  fi
  [[ -n $nvcc ]] || refuse "CUDA cannot be built: nvcc is not on the PATH, in CUDA_HOME or in /usr/local/cuda"
fi
missing=()
for tool in cmake ninja c++; do command -v "$tool" >/dev/null || missing+=("$tool"); done
((${#missing[@]} == 0)) || refuse "the build cannot start, missing: ${missing[*]}"

# ---- build: everything, or the grains alone
mkdir -p "$logs"
rm -rf "${logs:?}"/* # a coupled run leaves a folder
results=() # rows of the table
failed=0
note() { # STEP RESULT SECONDS
  results+=("| $1 | ${2//|/ } | $3 s |")
  say "$1: $2"
}
lack() { failed=1; note "$@"; }

googletest=${GOOGLETEST:-}
configure() { # LOG, then options
  local log=$1
  shift
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTRACKBED_BENCHMARKS=ON \
    -DTRACKBED_WARNINGS_ARE_ERRORS=OFF -DTRACKBED_GOOGLETEST="$googletest" -DCMAKE_CUDA_FLAGS=--split-compile=0 \
    -DTRACKBED_CUDA="$([[ $backend == cuda ]] && echo ON || echo OFF)" "${architecture[@]}" "$@" >"$log" 2>&1
}
first_error() { grep -m 1 -A 3 'CMake Error' "$1" | tr -s ' \n' ' ' | cut -c 1-200 || true; }

SECONDS=0
tests=(unit_dem verification_dem parallel_dem)
targets=("${tests[@]}" benchmark_dem_gpu)
coupled=0
if [[ $backend == cuda ]] && configure "$logs/configure.log" -DTRACKBED_DEM_ONLY=OFF; then
  coupled=1
  targets+=(trackbed)
else
  rm -f "$build/CMakeCache.txt"
  if ! configure "$logs/configure_dem.log" -DTRACKBED_DEM_ONLY=ON; then
    if [[ -z $googletest && -f /usr/src/googletest/CMakeLists.txt ]]; then googletest=/usr/src/googletest; fi
    rm -f "$build/CMakeCache.txt"
    if [[ -z $googletest ]] || ! configure "$logs/configure_dem.log" -DTRACKBED_DEM_ONLY=ON; then
      rm -f "$build/CMakeCache.txt"
      configure "$logs/configure_bare.log" -DTRACKBED_DEM_ONLY=ON -DTRACKBED_TESTS=OFF || {
        cat "$logs/configure_bare.log" >&2
        refuse "configuring failed (see above)"
      }
      lack "tests" "not built: $(first_error "$logs/configure_dem.log"); GOOGLETEST=FOLDER names GoogleTest's source" 0
      tests=()
      targets=(benchmark_dem_gpu)
    fi
  fi
fi
if [[ $backend == cuda ]] && ! grep -q 'CUDA backend: ON' "$logs"/configure*.log; then
  refuse "CUDA cannot be built: $(grep -h 'CUDA backend' "$logs"/configure*.log | tail -n 1); see $build/nvcc_probe/log"
fi
if ! ninja -C "$build" "${targets[@]}" >"$logs/build.log" 2>&1; then
  tail -n 30 "$logs/build.log" >&2
  say "the build failed (see above, and $logs/build.log); docs/gpu.md is as it was"
  exit 1
fi
if ((coupled)); then
  note "build" "all of Trackbed ${architecture[*]}" "$SECONDS"
elif [[ $backend == cuda ]]; then
  note "build" "the grains alone ${architecture[*]}: $(first_error "$logs/configure.log")" "$SECONDS"
else
  note "build" "the grains alone, without CUDA" "$SECONDS"
fi
bin=$build/bin
benchmark=$bin/benchmark_dem_gpu
if [[ $backend == cuda ]]; then
  SECONDS=0
  # Steps that fail are what the rest is there to explain.
  if ! timeout 60 "$benchmark" --backend cuda --small --shape sphere --grains 100 >"$logs/first.log" 2>&1; then
    if grep -q 'cannot be used' "$logs/first.log"; then refuse "no GPU to use: $(tail -n 1 "$logs/first.log")"; fi
    lack "first steps" "failed, or not finished in 60 s: $(tail -n 1 "$logs/first.log")" "$SECONDS"
  fi
fi

# ---- tests: in shards, since most simulate a few grains for many steps and wait for the GPU's answer
export TRACKBED_TEST_BACKEND=$backend OMP_WAIT_POLICY=passive
run_tests() { # STEP PROGRAM FILTER SHARDS SECONDS
  local step=$1 program=$2 filter=$3 shards=$4 limit shard pids=() all passed skipped wrong
  limit=$(seconds "$5")
  if ((limit < 5)); then
    lack "$step" "not run: no time left" 0
    return
  fi
  SECONDS=0
  for ((shard = 0; shard < shards; ++shard)); do
    GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard OMP_NUM_THREADS=2 timeout "$limit" \
      "$bin/$program" --gtest_filter="$filter" --gtest_color=no >"$logs/$step.$shard.log" 2>&1 &
    pids+=($!)
  done
  local pid
  for pid in "${pids[@]}"; do wait "$pid" || true; done
  all=$("$bin/$program" --gtest_filter="$filter" --gtest_list_tests | grep -c '^  ' || true)
  passed=$(count '^\[       OK \]' "$logs/$step".*.log)
  skipped=$(count '^\[  SKIPPED \].* ms)$' "$logs/$step".*.log)
  wrong=$(count '^\[  FAILED  \].* ms)$' "$logs/$step".*.log)
  local text="$passed passed, $wrong failed, $skipped skipped"
  local left=$((all - passed - skipped - wrong))
  ((left == 0)) || text+=", $left not finished in $limit s, or its program ended early"
  if ((wrong > 0)); then
    text+=": $(grep -h '^\[  FAILED  \].* ms)$' "$logs/$step".*.log | awk '{ print $4 }' | tr '\n' ' ')"
  fi
  if ((wrong == 0 && left == 0 && passed > 0)); then note "$step" "$text" "$SECONDS"; else lack "$step" "$text" "$SECONDS"; fi
}
again='*.TheSameAgainToTheLastBit' # a rerun is bit-identical
parity="OneByOne.*:Gpu.*-$again"

# ---- sanitizers: on a small bed and on ten steps of every law, of clumps, bonds, periods and facets; then on the quick
# scenes, whose packings are made before without them
sanitizer=$(PATH=$PATH:/usr/local/cuda/bin:$(dirname -- "${nvcc:-.}") command -v compute-sanitizer || true)
sanitize() { # STEP TOOL COMMAND…, each in one word
  local step=$1 tool=$2 status=0 limit summary scene log words
  log=$logs/${step//[ ,]/_}.log
  [[ -n $sanitizer ]] || {
    lack "$step" "not run: compute-sanitizer is not installed" 0
    return
  }
  SECONDS=0
  : >"$log"
  for scene in "${@:3}"; do
    limit=$(seconds 60)
    ((status == 0)) || break
    if ((limit < 5)); then
      status=124
      break
    fi
    read -ra words <<<"$scene"
    timeout "$limit" "$sanitizer" --tool "$tool" --error-exitcode 9 "${words[@]}" >>"$log" 2>&1 || status=$?
  done
  summary=$(sanitizer_summary "$log")
  case $status in
    0) note "$step" "clean: ${summary:-no summary}" "$SECONDS" ;;
    124) lack "$step" "not finished in time; so far ${summary:-nothing reported}" "$SECONDS" ;;
    *) lack "$step" "status $status; ${summary:-$(tail -n 1 "$log")}" "$SECONDS" ;;
  esac
}
sanitize_beds() { # TOOL
  local commands=("$benchmark --backend cuda --small --shape clump3 --grains 200 --precision mixed")
  if ((${#tests[@]})); then
    commands+=("$bin/parallel_dem --gtest_filter=Gpu.ClumpsPeriodsAndBondsStepByStep:Gpu.MixedPrecision")
  fi
  sanitize "$1" "$1" "${commands[@]}"
}
sanitize_scenes() { # TOOL: each scene from its packing to a millisecond of its first stage
  local step="$1, quick scenes" scene run words commands=() unpacked=() limit
  if ((!coupled)); then
    lack "$step" "not run: needs the whole of Trackbed" 0
    return
  fi
  export TRACKBED_CACHE=$logs/cache
  while read -r scene; do
    run="$bin/trackbed run $scene --backend cuda --until 0.001 --overwrite --out $logs/scene_$(basename -- "$scene" .toml)"
    limit=$(seconds 60)
    read -ra words <<<"$run"
    if ((limit < 5)) || ! timeout "$limit" "${words[@]}" </dev/null >>"$logs/packings.log" 2>&1; then
      unpacked+=("$(basename -- "$scene" .toml)")
    else
      commands+=("$run")
    fi
  done < <(scenes_with_grains "$root/configs/quick")
  if ((${#unpacked[@]})); then lack "$step: ${unpacked[*]}" "not run: no packing in time; $(tail -n 1 "$logs/packings.log" 2>/dev/null)" 0; fi
  if ((${#commands[@]})); then sanitize "$step" "$1" "${commands[@]}"; fi
}

# ---- speed
measure() {
  local status=0 size=() limit
  limit=$(seconds 150)
  [[ $backend == cuda ]] || size=(--small)
  SECONDS=0
  if ((limit < 5)); then
    lack "benchmarks" "not run: no time left" 0
    return
  fi
  timeout "$limit" "$benchmark" --backend "$backend" "${size[@]}" >"$logs/benchmark.log" 2>"$logs/benchmark.errors" || status=$?
  case $status in
    0) note "benchmarks" "see below" "$SECONDS" ;;
    124) lack "benchmarks" "not finished in $limit s; see below" "$SECONDS" ;;
    *) lack "benchmarks" "status $status: $(tail -n 1 "$logs/benchmark.errors")" "$SECONDS" ;;
  esac
}

# ---- coupled: the quick sleeper on stones of ten spheres
couple() {
  local limit
  if [[ $backend == omp ]]; then
    note "one sleeper on clumps, coupled" "not rehearsed: needs the whole of Trackbed" 0
    return
  fi
  limit=$(seconds 120)
  if ((limit < 5 || !coupled)); then
    lack "one sleeper on clumps, coupled" "not run: $( ((coupled)) && echo no time left || echo needs the whole of Trackbed)" 0
    return
  fi
  SECONDS=0
  cat >"$logs/sleeper_clumps.toml" <<END
include = "$root/configs/quick/one_sleeper.toml"
title = "One sleeper, quick, on clumps"
[[grains.shape]]
name = "stone1"
file = "$root/meshes/ballast/stone1.clump10.csv"
[packing]
shapes = ["stone1"]
END
  if timeout "$limit" "$bin/trackbed" run "$logs/sleeper_clumps.toml" --backend cuda --out "$logs/sleeper" --overwrite \
    >"$logs/sleeper.log" 2>&1; then
    note "one sleeper on clumps, coupled, 1 process" "shares of the wall time: $(wall_shares "$logs/sleeper/summary.json")" "$SECONDS"
  else
    lack "one sleeper on clumps, coupled" "stopped: $(tail -n 1 "$logs/sleeper.log")" "$SECONDS"
  fi
}

# ---- what matters most comes first
touch "$logs/benchmark.log"
if ((${#tests[@]})); then
  run_tests parity parallel_dem "$parity" 2 90
  run_tests rerun parallel_dem "$again" 1 60
fi
measure
[[ $backend == cuda ]] && sanitize_beds memcheck
couple
if ((${#tests[@]})); then
  run_tests unit unit_dem '*' 4 60
  run_tests verification verification_dem '*' 4 120
fi
[[ $backend == cuda ]] && sanitize_beds racecheck && sanitize_beds initcheck
((${#tests[@]})) && run_tests parallel parallel_dem "-OneByOne.*:Gpu.*" 2 60
[[ $backend == cuda ]] && sanitize_scenes memcheck && sanitize_scenes racecheck && sanitize_scenes initcheck

# ---- the page
# shellcheck disable=SC2016  # backquotes are of the page
commit=$(git -C "$root" rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
git -C "$root" diff --quiet HEAD 2>/dev/null || commit+=", with changes"
device=$(nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader 2>/dev/null | head -n 1 || true)
cuda=$([[ -n $nvcc ]] && "$nvcc" --version | sed -n 's/.*release \([0-9.]*\).*/\1/p' || echo none)
{
  if [[ $backend == cuda ]]; then
    printf '# Measured on a GPU\n\n'
  else
    printf '# Rehearsal on a processor: nothing here was measured on a GPU\n\n'
  fi
  printf 'Written by `./trackbed gpu-check` on %s.\n\n' "$(date -u '+%Y-%m-%d %H:%M UTC')"
  printf -- '- Device: %s\n- CUDA: %s\n- Commit: %s\n' "${device:-none}" "$cuda" "$commit"
  printf -- '- Again: `./trackbed gpu-check`; the logs are in `build/gpu/check`\n\n'
  printf '## Steps\n\n| step | result | took |\n|---|---|---|\n'
  printf '%s\n' "${results[@]}"
  printf '\n## Beds\n\nSettings, beds and the floor: head of `tests/benchmarks/dem_gpu.cpp`. No energy ledger.\n\n'
  cat "$logs/benchmark.log"
  if ! grep -q '^### Targets' "$logs/benchmark.log"; then
    printf '\n### Targets, of an H100\n\n| bed | target | measured | verdict |\n|---|---|---|---|\n'
  fi
  exchange_row "$logs/sleeper/summary.json"
} >"$page.new"
mv "$page.new" "$page"
say "written: $page"
exit $failed
