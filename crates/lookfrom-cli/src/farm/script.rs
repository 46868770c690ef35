//! job.sh: the tasks of a job and their merge, for any scheduler and by hand.

use super::{Job, quoted};
use crate::film::ENVIRONMENT;

/// The script, and the options of each frame.
pub(super) fn files(job: &Job) -> Vec<(&'static str, String)> {
    let frames: String = job.frames.iter().map(|options| format!("{options}\n")).collect();
    vec![("job.sh", script(job)), ("frames.txt", frames)]
}

fn script(job: &Job) -> String {
    let option = |option: &String| match option.strip_prefix(ENVIRONMENT) {
        // A path relative to this folder.
        Some(path) if !path.starts_with('/') => format!(" {ENVIRONMENT}\"$here\"/{}", quoted(path)),
        _ => format!(" {}", quoted(option)),
    };
    SCRIPT
        .replace("@TASKS@", &job.tasks().to_string())
        .replace("@PARTS@", &job.parts.to_string())
        .replace("@FIRST@", &job.numbers.0.to_string())
        .replace("@DIGITS@", &job.numbers.1.to_string())
        .replace("@FRAMES@", &job.frames.len().to_string())
        .replace("@OPTIONS@", &job.options.iter().map(option).collect::<String>())
        .replace("@SCENE@", &quoted(&job.scene_from_folder))
        .replace("@NAME@", &quoted(&job.name))
}

const SCRIPT: &str = r##"#!/bin/sh
# Written by lookfrom farm.
#
#   sh job.sh part 5      renders task 5 of @TASKS@; 5-8 renders several
#   sh job.sh merge       renders what is missing or damaged, and merges the parts of each frame
#
# Safe to repeat: a part that is complete stays, one that was stopped goes on from its last checkpoint.
# LOOKFROM is the program, SCENE the scene, FOLDER the folder of parts and pictures.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
name=@NAME@
parts=@PARTS@
frames=@FRAMES@
: "${LOOKFROM:=lookfrom}" "${FOLDER:=$here}"
if [ -z "${SCENE:-}" ]; then
    SCENE=$here/@SCENE@
fi

# The film of part $2 of frame $1.
film_of() {
    printf '%s/parts/%05d-%06d.exr' "$FOLDER" "$1" "$2"
}

# Part $2 of frame $1.
render() {
    of_frame=$(sed -n "$1p" "$here/frames.txt")
    "$LOOKFROM" render "$SCENE" -o "$(film_of "$1" "$2")" --film --continue --quiet \
        --part "$2/$parts"@OPTIONS@ ${of_frame:+"$of_frame"}
}

# Task $1, from 1.
task() {
    render $((($1 - 1) / parts + 1)) $((($1 - 1) % parts + 1))
}

# Frame $1.
merge() {
    if [ "$frames" = 1 ]; then
        whole=$FOLDER/$name.exr
    else
        whole=$FOLDER/$name-$(printf '%0@DIGITS@d' $(($1 - 1 + @FIRST@))).exr
    fi
    frame=$1
    part=1
    set --
    while [ $part -le $parts ]; do
        set -- "$@" "$(film_of "$frame" $part)"
        part=$((part + 1))
    done
    if ! "$LOOKFROM" merge --quiet -o "$whole" "$@"; then
        part=1
        bad=$("$LOOKFROM" merge --quiet --check "$@") || true
        for film in "$@"; do
            if printf '%s\n' "$bad" | grep -qxF -- "$film"; then
                render "$frame" $part
            fi
            part=$((part + 1))
        done
        "$LOOKFROM" merge --quiet -o "$whole" "$@"
    fi
    echo "$whole"
}

usage() {
    echo "usage: sh job.sh part K, sh job.sh part K-L, sh job.sh merge; K and L are from 1 to @TASKS@" >&2
    exit 2
}

case "${1:-}" in
part)
    first=${2%-*}
    last=${2#*-}
    for number in "$first" "$last"; do
        case $number in
        '' | *[!0-9]*) usage ;;
        esac
    done
    if ! { [ 1 -le "$first" ] && [ "$first" -le "$last" ] && [ "$last" -le @TASKS@ ]; }; then
        usage
    fi
    while [ "$first" -le "$last" ]; do
        task "$first"
        first=$((first + 1))
    done
    ;;
merge)
    frame_number=1
    while [ $frame_number -le $frames ]; do
        merge $frame_number
        frame_number=$((frame_number + 1))
    done
    ;;
*) usage ;;
esac
"##;
