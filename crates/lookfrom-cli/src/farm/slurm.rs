//! Slurm: an array job with a task for each part, and a merge that waits for it.

use super::{Job, quoted};

/// Slurm's usual limit of an array's size (`MaxArraySize` is 1001).
const MOST_TASKS: u64 = 1000;

/// The script that submits the job.
pub(super) fn files(job: &Job) -> Vec<(&'static str, String)> {
    let each = job.tasks().div_ceil(MOST_TASKS);
    let script = SUBMIT
        .replace("@NAME@", &quoted(&job.name))
        .replace("@EACH@", &each.to_string())
        .replace("@TASKS@", &job.tasks().to_string())
        .replace("@ARRAY@", &job.tasks().div_ceil(each).to_string());
    vec![("submit.sh", script)]
}

const SUBMIT: &str = r##"#!/bin/sh
# Written by lookfrom farm: sh submit.sh [options of sbatch, such as --partition=render --cpus-per-task=32]
#
# Parts that are preempted or requeued go on from their last checkpoint; the merge renders what failed.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
mkdir -p "$here/logs"
export here
array=$(sbatch --parsable --job-name=@NAME@ --array=1-@ARRAY@ --requeue --open-mode=append \
    --output="$here/logs/part-%a.txt" "$@" <<'END'
#!/bin/sh
first=$(((SLURM_ARRAY_TASK_ID - 1) * @EACH@ + 1))
last=$((first + @EACH@ - 1))
[ $last -le @TASKS@ ] || last=@TASKS@
exec sh "$here/job.sh" part "$first-$last"
END
)
merge=$(sbatch --parsable --job-name=@NAME@-merge --dependency="afterany:$array" --requeue --open-mode=append \
    --output="$here/logs/merge.txt" "$@" <<'END'
#!/bin/sh
exec sh "$here/job.sh" merge
END
)
echo "parts: job $array, merge: job $merge, logs: $here/logs"
"##;
