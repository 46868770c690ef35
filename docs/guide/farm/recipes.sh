#!/bin/bash
# Runs the recipes of docs/guide/farm.md from beginning to end on this machine, with workers killed and jobs requeued in
# the middle, and compares the bytes of each picture with those of one render.
#
#   docs/guide/farm/recipes.sh [PROGRAM] [RECIPE ...]      recipes: hand openjd dask hyperqueue slurm frames
#
# Installs OpenJD, Dask and HyperQueue into a temporary Python environment; Slurm is used where it is installed
# (`apt-get install slurm-wlm`) and this is root. What cannot be run is skipped, and said.
set -euo pipefail
root=$(cd "$(dirname "$0")/../../.." && pwd)
LOOKFROM=$(realpath "${1:-$root/target/release/lookfrom}")
export LOOKFROM
shift || true
recipes=("${@:-}")
[[ -n "${recipes[0]}" ]] || recipes=(hand openjd dask hyperqueue slurm frames)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
scene=$root/scenes/cornell.toml
size=(--width 160 --height 120)
options=("${size[@]}" --samples 64)
cd "$work"
venv=$work/venv
failed=0

say() { printf '%s\n' "$*"; }
skipped() { say "skipped: $1: $2"; }

# Compares a job's picture with that of one render.
same() {
    if cmp -s "$2" "$3"; then say "same bytes: $1"; else say "DIFFERENT: $1"; failed=1; fi
}

packages() {
    [[ -x $venv/bin/python ]] || python3 -m venv "$venv" || return
    "$venv/bin/pip" install -q "$@"
}

# Kills all renders of parts, five times.
killer() {
    for _ in 1 2 3 4 5; do
        sleep 0.5
        pkill -KILL -f -- "$LOOKFROM render .*--continue" || true
    done
}

mkdir one
"$LOOKFROM" render "$scene" "${options[@]}" -q --film -o one/cornell.exr

for recipe in "${recipes[@]}"; do
    job=$work/$recipe
    case $recipe in
    hand)
        "$LOOKFROM" farm slurm "$scene" "${options[@]}" --parts 7 -o "$job" 2> /dev/null
        sh "$job/job.sh" part 5-7
        sh "$job/job.sh" part 2-5
        printf x >> "$job/parts/00001-000003.exr"
        sh "$job/job.sh" merge > /dev/null
        same "by hand, with a damaged part and a missing one" one/cornell.exr "$job/cornell.exr"
        ;;
    openjd)
        if ! packages openjd-cli; then skipped openjd "PyPI is out of reach"; continue; fi
        "$LOOKFROM" farm openjd "$scene" "${options[@]}" --parts 8 -o "$job" 2> /dev/null
        run=("$venv/bin/openjd" run "$job/template.json" -p "file://$job/parameters.json" --step Merge --run-dependencies -p "Lookfrom=$LOOKFROM" -p TasksPerChunk=3)
        "$venv/bin/openjd" check "$job/template.json" > /dev/null
        "${run[@]}" > openjd.log
        same "OpenJD, chunks of 3" one/cornell.exr "$job/cornell.exr"
        # The scene under another path, by a rule of path mapping.
        rm -r "$job/parts" "$job/cornell.exr"
        ln -s "$root" mapped
        rules="{\"version\": \"pathmapping-1.0\", \"path_mapping_rules\": [{\"source_path_format\": \"POSIX\", \"source_path\": \"$root\", \"destination_path\": \"$work/mapped\"}]}"
        "${run[@]}" --path-mapping-rules "$rules" > openjd-mapped.log
        grep -q "$work/mapped" openjd-mapped.log || say "note: the log does not name the mapped path"
        "$LOOKFROM" compare "$job/cornell.exr" one/cornell.exr --tolerance 0 > /dev/null
        "$LOOKFROM" develop "$job/cornell.exr" -o a.pfm
        "$LOOKFROM" develop one/cornell.exr -o b.pfm
        same "OpenJD, with path mapping (the light)" a.pfm b.pfm
        ;;
    dask)
        if ! packages distributed; then skipped dask "PyPI is out of reach"; continue; fi
        "$LOOKFROM" farm dask "$scene" "${options[@]}" --parts 12 -o "$job" 2> /dev/null
        "$venv/bin/dask" scheduler --port 18786 --dashboard-address :0 > dask.log 2>&1 &
        scheduler=$!
        workers=()
        for _ in 1 2 3; do
            "$venv/bin/dask" worker tcp://127.0.0.1:18786 --nthreads 1 --nworkers 1 --no-dashboard >> dask.log 2>&1 &
            workers+=($!)
        done
        sleep 8
        (sleep 2; kill -KILL "${workers[1]}"; pkill -KILL -P "${workers[1]}" || true) &
        "$venv/bin/python" "$job/submit.py" tcp://127.0.0.1:18786 2>> dask.log
        kill "${workers[0]}" "${workers[2]}" $scheduler 2> /dev/null || true
        same "Dask, a worker killed" one/cornell.exr "$job/cornell.exr"
        ;;
    hyperqueue)
        if ! packages hyperqueue; then skipped hyperqueue "PyPI is out of reach"; continue; fi
        "$LOOKFROM" farm hyperqueue "$scene" "${options[@]}" --parts 10 -o "$job" 2> /dev/null
        killer &
        "$venv/bin/python" - "$job" << 'END' > hyperqueue.log 2>&1
import sys
sys.path.insert(0, sys.argv[1])
import submit
from hyperqueue.cluster import LocalCluster, WorkerConfig

with LocalCluster() as cluster:
    for _ in range(3):
        cluster.start_worker(WorkerConfig(cores=1))
    assert submit.run(cluster.client())
END
        same "HyperQueue, renders killed" one/cornell.exr "$job/cornell.exr"
        ;;
    slurm)
        if ! command -v slurmctld > /dev/null || [[ $(id -u) != 0 ]]; then
            skipped slurm "no slurmctld here, or not root"
            continue
        fi
        "$root/docs/guide/farm/one-node-slurm.sh" start
        "$LOOKFROM" farm slurm "$scene" "${size[@]}" --samples 256 --parts 6 -o "$job" 2> /dev/null
        "$LOOKFROM" render "$scene" "${size[@]}" --samples 256 -q --film -o one/more.exr
        ids=$(sh "$job/submit.sh")
        say "$ids"
        array=$(sed 's/parts: job \([0-9]*\).*/\1/' <<< "$ids")
        sleep 3
        scontrol requeue "${array}_1" || true
        for _ in $(seq 300); do
            [[ -e $job/cornell.exr ]] && break
            sleep 1
        done
        sleep 1
        same "Slurm, an array job with a task requeued" one/more.exr "$job/cornell.exr"
        "$root/docs/guide/farm/one-node-slurm.sh" stop
        ;;
    frames)
        model=$root/scenes/models/star.ply
        "$LOOKFROM" farm slurm "$model" --size 80 --samples 8 --turntable 3 --parts 2 -o "$job" 2> /dev/null
        sh "$job/job.sh" part 1-6
        sh "$job/job.sh" merge > /dev/null
        "$LOOKFROM" render "$model" --size 80 --samples 8 --turntable 3 -q --film -o "$job/one.exr"
        for frame in 0 1 2; do
            same "frame $frame of a turntable" "$job/one-00$frame.exr" "$job/star-00$frame.exr"
        done
        ;;
    *)
        say "no recipe $recipe"
        failed=1
        ;;
    esac
done
exit $failed
