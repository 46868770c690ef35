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

picture() { "$LOOKFROM" render "$1" -o "$2" --quiet --strict; }

if (($# > 0)); then
    for name in "$@"; do
        picture "docs/guide/scenes/$name.toml" "docs/guide/img/$name.png"
    done
    exit
fi

mkdir -p docs/guide/img docs/img
for scene in docs/guide/scenes/*.toml; do
    picture "$scene" "docs/guide/img/$(basename "$scene" .toml).png"
done
picture scenes/hero.toml docs/img/hero.png
"$LOOKFROM" inspect scenes/glass-and-mirror.toml 195 275 --svg docs/guide/img/inspector-glass.svg > /dev/null
