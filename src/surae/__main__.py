"""`python -m surae` is `surae`."""

from surae.cli import main

if __name__ == "__main__":
    main()
