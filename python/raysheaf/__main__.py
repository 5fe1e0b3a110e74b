"""``python -m raysheaf``: runs the command line program that the package includes."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def main() -> None:
    program = Path(__file__).parent / "bin" / "raysheaf"
    if not program.exists():
        sys.exit("raysheaf: this build of the package has no command line")
    os.execv(program, ["raysheaf", *sys.argv[1:]])


if __name__ == "__main__":
    main()
