"""``python -m rayflock``: the program rayflock. ``--help`` tells all it can do."""

import signal
import sys

from rayflock import _native


def main() -> int:
    """Does what the command line asks for and returns the exit code."""
    # Python's own handler of Ctrl-C would only be heard once the program has ended.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.run_program(["python -m rayflock", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
