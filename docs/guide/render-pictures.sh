#!/usr/bin/env bash
# Renders the pictures of the guide: docs/guide/img/NAME.png from docs/guide/scenes/NAME.toml, and docs/img/hero.png.
#
#   docs/guide/render-pictures.sh              all of them
#   docs/guide/render-pictures.sh light-spot   those that are named
#
# Builds the command, unless LOOKFROM names a binary. The same scene gives the same bytes on any machine, so a picture that
# changes here is one that the program changed.
set -euo pipefail
cd "$(dirname "$0")/../.."

if [[ -z ${LOOKFROM:-} ]]; then
    cargo build --release --bin lookfrom
    LOOKFROM=${CARGO_TARGET_DIR:-target}/release/lookfrom
fi

picture() { "$LOOKFROM" render "$@" --quiet --strict; }

of_guide() {
    local more=()
    # Light from the whole sky is noisy at the number of samples that suits the others, and noise makes a large PNG.
    [[ $1 == light-environment ]] && more=(--samples 512)
    picture "docs/guide/scenes/$1.toml" -o "docs/guide/img/$1.png" ${more[@]+"${more[@]}"}
}

if (($# > 0)); then
    for name in "$@"; do of_guide "$name"; done
    exit
fi

mkdir -p docs/guide/img docs/img
for scene in docs/guide/scenes/*.toml; do
    of_guide "$(basename "$scene" .toml)"
done
picture scenes/hero.toml -o docs/img/hero.png
"$LOOKFROM" inspect scenes/hero.toml 330 300 --depth 2 --svg docs/guide/img/inspector-glass.svg > /dev/null
"$LOOKFROM" inspect scenes/hero.toml 330 300 --integrator path --sample 4 --svg docs/guide/img/inspector-path.svg > /dev/null
