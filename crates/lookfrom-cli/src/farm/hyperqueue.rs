//! HyperQueue, by its Python interface (PyPI `hyperqueue`): a task for each part, then a merge.

use super::Job;
use lookfrom_scene::json::line;

/// The Python script that submits the job and waits for it.
pub(super) fn files(job: &Job) -> Vec<(&'static str, String)> {
    // A JSON string is a Python string.
    vec![(
        "submit.py",
        SUBMIT.replace("@NAME@", &line(&job.name)).replace("@TASKS@", &job.tasks().to_string()),
    )]
}

const SUBMIT: &str = r##"#!/usr/bin/env python3
# Written by lookfrom farm: python3 submit.py [folder of the server, as for hq --server-dir] [cores of a part]
#
# Tasks of workers that die are started again by HyperQueue, and go on from their last checkpoint.
import os
import sys
from pathlib import Path

from hyperqueue import Client, Job
from hyperqueue.ffi.protocol import ResourceRequest

HERE = os.path.dirname(os.path.abspath(__file__))
NAME = @NAME@
TASKS = @TASKS@


def submit(client, name, tasks, cores):
    """Runs job.sh with each of the arguments; returns whether all succeeded."""
    job = Job(default_workdir=HERE, max_fails=None, name=name)
    log = os.path.join(HERE, "logs", name)
    for number, arguments in enumerate(tasks):
        job.program(
            ["sh", os.path.join(HERE, "job.sh"), *arguments],
            env={key: os.environ[key] for key in ("PATH", "LOOKFROM", "SCENE", "FOLDER") if key in os.environ},
            stdout=f"{log}-{number}.txt",
            stderr=f"{log}-{number}.txt",
            resources=ResourceRequest(cpus=cores),
            crash_limit=100,
        )
    return client.wait_for_jobs([client.submit(job)], raise_on_error=False)


def run(client, cores=1):
    os.makedirs(os.path.join(HERE, "logs"), exist_ok=True)
    parts = [["part", str(task)] for task in range(1, TASKS + 1)]
    if not submit(client, f"{NAME}-parts", parts, cores):
        print("some parts failed; the merge renders them", file=sys.stderr)
    return any(submit(client, f"{NAME}-merge", [["merge"]], cores) for _ in range(3))


if __name__ == "__main__":
    server = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    sys.exit(0 if run(Client(server), *map(int, sys.argv[2:3])) else 1)
"##;
