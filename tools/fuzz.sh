#!/usr/bin/env bash
# Runs luxel_fuzz (tests/fuzz) on each target for some seconds, from the corpus and what earlier runs
# have found, and prints a row per target: inputs, coverage, findings. Ends with 1 when there is a finding.
#
#   tools/fuzz.sh SECONDS [TARGET|all [INPUTS]]     stops earlier after so many inputs
set -uo pipefail
cd "$(dirname "$0")/.."
seconds=${1:?seconds per target}
program=build/fuzz/bin/luxel_fuzz
targets=${2:-all}
[[ $targets == all ]] && targets=$("$program" 2>&1 | sed -n 's/^  //p')
status=0
version=$(sed -n 's/^project(luxel VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
echo "version,target,inputs,edges covered,time [s],findings"
for target in $targets; do
  grown=build/fuzz/grown/$target findings=build/fuzz/findings/$target log=build/fuzz/$target.log
  mkdir -p "$grown" "$findings"
  # Draco may take ten seconds for a short input (docs/guide/untrusted.md), and more on a busy machine.
  arguments=(--target="$target" -max_total_time="$seconds" -timeout=100 -report_slow_units=100
             -rss_limit_mb=4096 -malloc_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="$findings/")
  dictionary=tests/fuzz/dictionaries/${target%_binary}.dict
  [[ -n ${3:-} ]] && arguments+=(-runs="$3")
  [[ -f $dictionary ]] && arguments+=(-dict="$dictionary")
  # Memory that a library leaks when it throws is freed by the end of the process, and no finding: a
  # million inputs leave a gigabyte.
  ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=0 \
    "$program" "${arguments[@]}" "$grown" "tests/fuzz/corpus/$target" > "$log" 2>&1 || status=1
  inputs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  covered=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  took=$(sed -n 's/^Done [0-9]* runs in \([0-9]*\) second.*/\1/p' "$log")
  echo "$version,$target,${inputs:-0},${covered:-0},${took:-0},$(find "$findings" -type f | wc -l)"
done
exit $status
