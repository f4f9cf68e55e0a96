"""What `surae` and `python -m surae` run; the latter without the folder that -m looks in first."""

import sys


def run() -> None:
    """The command line; Ctrl-C ends it in one line while it is still being imported, too."""
    try:
        from surae.cli import main

        main()
    except KeyboardInterrupt:
        sys.stderr.write("surae: stopped by the user\n")
        sys.exit(130)


if __name__ == "__main__":
    if not sys.flags.safe_path:
        del sys.path[0]  # the current folder: its files are somebody's data, not our programs
    run()
