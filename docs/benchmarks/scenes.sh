#!/usr/bin/env bash
# Times every scene of scenes/ at its own settings, and prints the table of docs/benchmarks/scenes.md.
# docs/benchmarks/scenes.sh [FILE …]: those files instead. OPTIONS="--samples 4" is given to every render.
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo build --release --bin lookfrom
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# A number of the JSON summary, by its key.
value() { sed -n "s/^.*\"$1\": *\([0-9.e+-]*\).*$/\1/p" <<< "$summary" | head -n 1; }

echo '| scene | pixels | samples | rays (M) | build s | render s | Mrays/s | peak memory (MB) |'
echo '| --- | --- | --- | --- | --- | --- | --- | --- |'
[[ $# -gt 0 ]] || set -- scenes/*.toml
for file in "$@"; do
    summary=$(target/release/lookfrom render "$file" ${OPTIONS:-} -o "$out/picture.png" --quiet --json | tr ',{' '\n\n')
    row=("$(value width)" "$(value height)" "$(value samples)" "$(value total)" "$(value build)" "$(value render)"
        "$(value mrays_per_s)" "$(value peak_memory_bytes)")
    awk -v name="$(basename "$file")" '{ printf "| %s | %d × %d | %d | %.1f | %.2f | %.1f | %.2f | %.0f |\n",
        name, $1, $2, $3, $4 / 1e6, $5, $6, $7, $8 / 1e6 }' <<< "${row[*]}"
done
