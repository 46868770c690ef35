//! Dask's `distributed`: a future for each part, then a merge.

use super::Job;

/// The Python script that submits the job and waits for it.
pub(super) fn files(job: &Job) -> Vec<(&'static str, String)> {
    vec![("submit.py", SUBMIT.replace("@TASKS@", &job.tasks().to_string()))]
}

const SUBMIT: &str = r##"#!/usr/bin/env python3
# Written by lookfrom farm: python3 submit.py tcp://SCHEDULER:8786
#
# Tasks of workers that die are started again by Dask, and go on from their last checkpoint. Start workers with
# --nthreads 1 --no-nanny or more: a task uses all threads that lookfrom finds.
import os
import subprocess
import sys

from distributed import Client, as_completed

HERE = os.path.dirname(os.path.abspath(__file__))
TASKS = @TASKS@


def job(*arguments):
    subprocess.run(["sh", os.path.join(HERE, "job.sh"), *arguments], check=True, stdout=sys.stderr)


def main():
    client = Client(sys.argv[1])
    # A worker that dies takes its tasks with it; that says nothing about the tasks.
    client.run_on_scheduler(lambda dask_scheduler: setattr(dask_scheduler, "allowed_failures", 100))
    parts = [client.submit(job, "part", str(task), pure=False, retries=3) for task in range(1, TASKS + 1)]
    for done, part in enumerate(as_completed(parts, raise_errors=False), 1):
        error = f": {part.exception()}" if part.status == "error" else ""
        print(f"{done} of {TASKS} parts{error}", file=sys.stderr)
    # The merge renders parts that failed.
    client.submit(job, "merge", pure=False, retries=3).result()


main()
"##;
