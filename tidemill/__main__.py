"""`tidemill`, also as `python -m tidemill`."""

from __future__ import annotations

import sys
from typing import NoReturn

from common.command import end_with
from common.distribution import reach_from_jobs
from tidemill.commands import call


def main() -> NoReturn:
    """Carry out the command that `sys.argv` gives."""
    reach_from_jobs()
    end_with(lambda: call(sys.argv[1:]))


if __name__ == "__main__":
    main()
