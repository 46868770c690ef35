"""`python -m lookfrom`: the command."""

import signal
import sys

from ._lookfrom import run_command


def main() -> int:
    """Runs the command with the arguments of this process, and returns its exit code."""
    # Python's handler of Ctrl-C would only take note of it until the command has ended. Where it is ignored, it stays so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_command(["lookfrom", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
