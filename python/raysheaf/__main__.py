"""``python -m raysheaf``: the command line, which the package brings along."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def main() -> None:
    program = Path(__file__).parent / "bin" / "raysheaf"
    if not program.exists():
        sys.exit("raysheaf: this build of the package came without the command line")
    os.execv(program, ["raysheaf", *sys.argv[1:]])


if __name__ == "__main__":
    main()
