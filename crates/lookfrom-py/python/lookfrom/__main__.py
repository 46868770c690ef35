"""`python -m lookfrom`: the command."""

import sys

from ._lookfrom import run_command


def main() -> int:
    """Runs the command with the arguments of this process, and returns its exit code."""
    return run_command(["lookfrom", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
