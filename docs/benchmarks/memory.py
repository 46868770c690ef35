#!/usr/bin/env python3
"""The most memory that the command takes for each of some files, a process for each: the largest ten, and the median.

    docs/benchmarks/memory.py target/release/lookfrom FILE...
"""

import os
import subprocess
import sys
import tempfile

program, *files = sys.argv[1:]
found = []
with tempfile.TemporaryDirectory() as folder:
    for file in files:
        out = os.path.join(folder, "out.png")
        command = [program, "render", file, "-o", out, "--size", "64", "--samples", "1", "--quiet"]
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        found.append((usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime, process.returncode, file))
found.sort(reverse=True)
for megabytes, seconds, code, file in found[:10]:
    print(f"{megabytes:6.0f} MiB {seconds:6.2f} CPU s  exit code {code}  {file}")
print(f"{len(found)} files, {sum(code == 0 for *_, code, _ in found)} rendered, median {found[len(found) // 2][0]:.0f} MiB")
