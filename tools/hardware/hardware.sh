#!/bin/sh
# Finds out everything that throng can about a GPU in nine minutes: tests, benchmarks, drawing. The machine needs
# nothing but a C library, coreutils, awk, sed, grep and a Vulkan driver. `./run bundle` puts this script beside the
# programs that it runs.
#
#   ./hardware [FOLDER]      writes records.jsonl, report.html, SUMMARY.md and log.txt there (default: ./results)
#   THRONG_TIME=SECONDS      for the whole run (540)
#   THRONG_DEVICE=NAME       a device's number or a part of its name (default: a hardware GPU if there is one)
set -u
fail() { echo "hardware: $*" >&2; exit 1; }
missing=
for program in timeout awk sed grep nproc du; do
  command -v $program > /dev/null || missing="$missing $program"
done
[ -z "$missing" ] || fail "these programs of coreutils, awk, sed and grep are missing:$missing"
time_s=${THRONG_TIME-540}
case $time_s in
  '' | 0* | *[!0-9]* | ?????????*) time_is_valid= ;;
  *) time_is_valid=$([ "$time_s" -lt 60 ] || echo yes) ;;
esac
[ -n "$time_is_valid" ] || fail "THRONG_TIME: '$time_s' is not a number of seconds, at least 60"
here=$(cd "$(dirname "$0")" && pwd)
out=${1-results}
mkdir -p "$out" || exit 1
out=$(cd "$out" && pwd)
work=$(mktemp -d) || exit 1
running=  # programs that limited() or run_shards() wait for
trap 'rm -rf "$work"' EXIT
trap 'stop 130' INT
trap 'stop 143' TERM
device=${THRONG_DEVICE-}
export THRONG_SOURCE="$here/source" THRONG_SHARED="$here/shared" HOME="$work" XDG_CACHE_HOME="$work/cache"
[ ! -f "$here/commit" ] || THRONG_COMMIT=$(cat "$here/commit")
export THRONG_COMMIT="${THRONG_COMMIT-}"

# One line for each benchmark: its name, its share of the time in percent, and its options, in order of importance. Time
# that a benchmark does not use goes to those after it.
steps() {
  cat <<TEXT
scan 14 --experiments levels,on_chip --budget $((time_s / 12)) $quick --json scan.jsonl
frame 14 --samples 15 $quick --json
control 3 --path device --characters $controlled --samples 15 --json
view 4 --path device --count $viewed --samples 9 --json
population 3 --path device --json
million 9 --json
draw 9 --against-vulkan --samples 3 --threads $(nproc) --isa $isa --json
TEXT
}

started=$(date +%s)
left() { echo $((started + time_s - $(date +%s))); }
log() { printf '%s\n' "$*" >> "$work/log"; }
say() { printf '%s\n' "$*"; }
# Runs a program in $work for at most $1 seconds. It runs in the background: the shell handles signals only while it
# waits.
limited() {
  (cd "$work" && exec timeout -k 5 "$@") &
  running=$!
  wait $running
  set -- $?
  running=
  return "$1"
}
# Runs all device tests for at most $1 seconds, in several processes, since their references and the driver's compiler
# keep one core busy each. Each process writes its own file. Returns the status of one that failed.
run_shards() {
  shard=0
  while [ $shard -lt "$shards" ]; do
    (cd "$work" && export GTEST_TOTAL_SHARDS="$shards" GTEST_SHARD_INDEX=$shard &&
      exec timeout -k 5 "$1" "$here/throng_tests" > "$work/tests.$shard" 2>&1) &
    running="$running $!"
    shard=$((shard + 1))
  done
  status=0
  for process in $running; do wait "$process" || status=$?; done
  running=
  return $status
}
is_timed_out() { [ "$1" -eq 124 ] || [ "$1" -eq 137 ]; }  # 137: it had to be killed
stop() {
  [ -z "$running" ] || { kill $running && wait $running; } 2> /dev/null
  exit "$1"
}
# At most the first and the last 200 kB of a file.
shortened() {
  if [ "$(wc -c < "$1")" -lt 400000 ]; then
    cat "$1"
  else
    head -c 200000 "$1"
    printf '\n[…]\n'
    tail -c 200000 "$1"
  fi
}
row() { printf '| %s | %s | %s |\n' "$@" >> "$work/steps"; say "$1: $2, $3"; }

# The host's driver may need a newer C++ library than the bundle's, and a process can have only one.
newest_of() { grep -aoh 'GLIBCXX_3\.4\.[0-9]*' "$@" | sort -V | tail -n 1; }
choose_cpp_library() {
  bundled=$here/lib/libstdc++.so.6
  for host in /usr/lib/x86_64-linux-gnu /lib/x86_64-linux-gnu /usr/lib64 /lib64 /usr/lib; do
    host=$host/libstdc++.so.6
    [ -f "$host" ] || continue
    [ "$(newest_of "$bundled")" = "$(newest_of "$bundled" "$host")" ] ||
      export LD_PRELOAD="$host${LD_PRELOAD:+:$LD_PRELOAD}"
    return
  done
}

# Whether a usable GPU is among the devices that THRONG_DEVICE selects. `throng devices` prints two lines for each
# device: its name, and its type and driver.
has_gpu() {
  "$here/throng" devices 2> /dev/null | awk -v wanted="$device" '
    BEGIN { wanted = tolower(wanted) }
    /^[0-9]/ { named = wanted ~ /^[0-9]+$/ ? $1 == wanted : wanted == "" || index(tolower($0), wanted) }
    /, driver / && !/; compiles only|; not usable/ && $1 != "cpu," && named { found = 1 }
    END { exit !found }'
}
find_driver() {
  has_gpu && return
  # Some containers mount NVIDIA's driver here without telling the loader.
  icd=/usr/local/nvidia/share/vulkan/icd.d/nvidia_icd.json
  if [ -z "${VK_DRIVER_FILES-}${VK_ICD_FILENAMES-}" ] && [ -f $icd ]; then
    export VK_DRIVER_FILES=$icd
    has_gpu && return
    unset VK_DRIVER_FILES
  fi
  "$here/throng" devices 2> /dev/null | grep ', driver ' | grep -qv '; compiles only\|; not usable'
}

# The result of each test in a log, one per line; the worst result if a test ran more than once.
states_of() {
  awk 'function not_ended() { if (runs != "") bad[runs] = "not_ended"; runs = "" }
    /^\[ RUN      \]/ { not_ended(); runs = $4 }
    /^\[       OK \] .*ms\)/ { state[$4] = "passed"; runs = "" }
    /^\[  SKIPPED \] .*ms\)/ { state[$4] = "skipped"; runs = "" }
    /^\[  FAILED  \] .*ms\)/ { bad[$4] = "failed"; runs = "" }
    END { not_ended(); for (name in bad) state[name] = bad[name]
      for (name in state) print state[name], name }' "$1" | sort
}

# The suites with tests that have neither passed nor been skipped.
suites_left() {
  states_of "$1" > "$work/states"
  "$here/throng_tests" --gtest_list_tests | awk -v states="$work/states" '
    BEGIN { while ((getline < states) > 0) if ($1 == "passed" || $1 == "skipped") done[$2] }
    /^[^ ]/ { suite = $1; next }
    !((suite $1) in done) && !(suite in seen) { seen[suite]; print suite }'
}

# Runs all device tests; then, suite by suite, those that failed or that a crash kept from running.
run_tests() {
  limit=$1
  begun=$(date +%s)
  run_shards "$limit"
  status=$?
  cat "$work"/tests.[0-9]* > "$work/tests"
  cp "$work/tests" "$work/tests.all"
  if [ $status -ne 0 ]; then
    for suite in $(suites_left "$work/tests"); do
      rest=$((begun + limit - $(date +%s)))
      [ $rest -gt 2 ] || break
      limited "$rest" "$here/throng_tests" --gtest_filter="$suite*" > "$work/suite" 2>&1
      cat "$work/suite" >> "$work/tests.all"
    done
  fi
  states_of "$work/tests.all" > "$work/states"
  of() { grep -c "^$1 " "$work/states"; }
  total=$("$here/throng_tests" --gtest_list_tests | grep -c '^ ')
  result="$(of passed) of $total passed, $(of skipped) skipped, $(of failed) failed, $(of not_ended) not ended"
  [ $status -lt 2 ] || is_timed_out $status || log "==== throng_tests ended with status $status"
  row "device tests" "$result, $((total - $(wc -l < "$work/states"))) not reached" "$(($(date +%s) - begun)) s"
  if grep -q '^failed \|^not_ended ' "$work/states"; then
    sed -n 's/^failed /failed: /p; s/^not_ended /not ended: /p' "$work/states" > "$work/failed"
    log "==== device tests"
    shortened "$work/failed" >> "$work/log"
    shortened "$work/tests.all" >> "$work/log"
  fi
}

# Runs a benchmark; keeps its records even if it fails or its time is over.
run_step() {
  name=$1
  limit=$2
  shift 2
  if ! "$here/throng" bench --help 2>/dev/null | grep -q "^  $name "; then
    row "$name" "not in this build" "0 s"
    return
  fi
  [ "$limit" -ge 5 ] || { row "$name" "not run: no time left" "0 s"; return; }
  begun=$(date +%s)
  limited "$limit" "$here/throng" bench "$name" --device "$device" "$@" > "$work/stdout" 2> "$work/stderr"
  status=$?
  cat "$work/$name.jsonl" "$work/stdout" 2>/dev/null | grep '^{.*}$' > "$work/records"
  cat "$work/records" >> "$out/records.jsonl"
  result="$(wc -l < "$work/records") records"
  if is_timed_out $status; then
    result="$result; stopped at its limit of $limit s"
  elif [ $status -ne 0 ]; then
    result="$result; failed ($status): $(grep . "$work/stderr" | tail -n 1 | tr '\r|' '  ' | cut -c1-200)"
  fi
  row "$name" "$result" "$(($(date +%s) - begun)) s"
  if [ $status -ne 0 ]; then
    log "==== throng bench $name --device '$device' $*"
    shortened "$work/stderr" >> "$work/log"
    shortened "$work/stdout" >> "$work/log"
  fi
}

choose_cpp_library
"$here/throng" devices > "$work/devices" 2>&1 || fail "the programs do not run here: $(head -n 1 "$work/devices")"
find_driver || fail "no Vulkan driver was found; if there is one, name its .json file in VK_DRIVER_FILES"
for file in records.jsonl report.html SUMMARY.md log.txt; do rm -f "$out/$file"; done
: > "$out/records.jsonl"; : > "$work/log"; : > "$work/steps"
"$here/throng" devices > "$work/devices" 2>&1
cat "$work/devices"
quick= controlled=1000,10000,100000 viewed=100000
has_gpu || quick=--quick controlled=1000 viewed=10000
shards=$(nproc)
[ "$shards" -le 16 ] || shards=16  # each opens its own device and needs memory for it
isa=all
if grep -q avx2 /proc/cpuinfo; then isa=avx2; fi

export THRONG_VALIDATION=off
# The tests get 40 percent of the time, the benchmarks `share`, and writing the results 4.
run_tests $((time_s * 40 / 100))
steps > "$work/list"
share=56
while read -r name percent options <&3; do
  share=$((share - percent))
  run_step "$name" $(($(left) - time_s * (share + 4) / 100)) $options
done 3< "$work/list"

set --
[ ! -f "$here/predictions.jsonl" ] || set -- --predictions "$here/predictions.jsonl"
"$here/throng" bench summary "$out/records.jsonl" "$@" --out "$work/summary.md" 2>> "$work/log" ||
  row summary "failed; see log.txt" "0 s"
"$here/throng" bench report "$out/records.jsonl" --tables --out "$out/report.html" 2>> "$work/log" ||
  row report "failed; see log.txt" "0 s"
{
  printf '# throng on this machine\n\n'
  printf 'Commit %s, %s, %s s in all.\n\n```\n' "${THRONG_COMMIT:-unknown}" "$(date -u '+%Y-%m-%d %H:%M UTC')" \
    $(($(date +%s) - started))
  cat "$work/devices"
  sed -n 's/^model name[^:]*: /processor: /p' /proc/cpuinfo | head -n 1
  printf '```\n\n| step | result | time |\n|---|---|---|\n'
  cat "$work/steps"
  [ ! -f "$work/failed" ] || { printf '\n'; sed 's/^/- /' "$work/failed"; }
  printf '\n'
  cat "$work/summary.md" 2>/dev/null
} > "$out/SUMMARY.md"
cp "$work/log" "$out/log.txt"
grep -E 'not run|not in this build|stopped|failed' "$work/steps" |
  grep -v ' 0 failed, 0 not ended, 0 not reached' > "$work/open"
if [ -s "$work/open" ]; then
  say "these could not be run, or not to the end:"
  sed 's/^| /  /; s/ | /: /; s/ | .*//' "$work/open"
fi
say "written to $out: $(cd "$out" && du -ch records.jsonl report.html SUMMARY.md log.txt | tail -n 1 | cut -f1)"
