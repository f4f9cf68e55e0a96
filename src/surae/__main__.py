"""`python -m surae` is `surae`, without the folder that Python's -m looks for modules in first."""

import sys

if __name__ == "__main__":
    if not sys.flags.safe_path:
        del sys.path[0]  # the current folder: its files are somebody's data, not our programs
    from surae.cli import main

    main()
