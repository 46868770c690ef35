#!/bin/bash
# 200 parts on four workers that are killed at random; parts are repeated, one is damaged. The merged film must have the
# bytes of one render.
#
#   docs/guide/farm/stress.sh [PROGRAM]
set -euo pipefail
root=$(cd "$(dirname "$0")/../../.." && pwd)
LOOKFROM=$(realpath "${1:-$root/target/release/lookfrom}")
export LOOKFROM
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
scene=$root/scenes/cornell.toml
options=(--width 96 --height 72 --samples 400)
"$LOOKFROM" farm slurm "$scene" "${options[@]}" --parts 200 -o job 2> /dev/null
"$LOOKFROM" render "$scene" "${options[@]}" -q --film -o job/one.exr

# A worker takes random parts, so that some are rendered twice at the same time, until all are there.
worker() {
    while [[ $(find job/parts -name '*.exr' 2> /dev/null | wc -l) -lt 200 ]]; do
        sh job/job.sh part $((RANDOM % 200 + 1)) 2> /dev/null || true
    done
}
for _ in 1 2 3 4; do worker & done
kills=0
while [[ $(jobs -r | wc -l) -gt 0 ]]; do
    sleep 0.$((RANDOM % 10))
    pkill -KILL -f -- "^$LOOKFROM render .*--continue" && kills=$((kills + 1)) || true
done
wait
printf 'damage' | dd of=job/parts/00001-000077.exr bs=1 seek=5000 conv=notrunc status=none
rm job/parts/00001-000123.exr
sh job/job.sh merge 2>&1
echo "$kills kills"
cmp job/one.exr job/cornell.exr && echo "same bytes: 200 parts"
