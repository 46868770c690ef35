#!/usr/bin/env bash
# What a picture costs: prints the table of docs/timings.md, a row for each scene in scenes/ and for each file that is named.
#
#   docs/timings.sh                                    our scenes, at their own size and samples
#   docs/timings.sh big.ply --width 1024 --samples 16  only what is named, with options of the command
#
# CPU time is that of all threads together, and does not depend on what else the machine does as much as the time on the wall.
set -euo pipefail
cd "$(dirname "$0")/.."

if [[ -z ${LOOKFROM:-} ]]; then
    cargo build --release --bin lookfrom
    LOOKFROM=${CARGO_TARGET_DIR:-target}/release/lookfrom
fi
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
export TIMEFORMAT='%U'

# A number of the summary, by its key.
number() { grep -o "\"$1\":[0-9.]*" "$out/summary" | head -n 1 | cut -d : -f 2; }

row() {
    local scene=$1 cpu
    shift
    cpu=$({ time "$LOOKFROM" render "$scene" -o "$out/picture.png" --quiet --json "$@" > "$out/summary"; } 2>&1)
    printf '| %s | %s × %s × %s | %.0f | %.2f | %.1f | %.1f | %.0f |\n' "$(basename "$scene")" "$(number width)" "$(number height)" \
        "$(number samples)" "$(($(number total) / 1000000))" "$(number build)" "$(number render)" "$cpu" \
        "$(($(number peak_memory_bytes) / 1000000))"
}

printf '| scene | pixels × samples | Mrays | build s | render s | CPU s | peak MB |\n'
printf '| --- | --- | ---: | ---: | ---: | ---: | ---: |\n'
if (($# > 0)); then
    row "$@"
else
    for scene in scenes/*.toml; do row "$scene"; done
fi
