"""Help and errors come at once: nothing that computes is imported for them."""

import json
import subprocess
import sys

import pytest

COMPUTING = {"numba", "scipy", "matplotlib", "h5py", "joblib", "jinja2", "pydantic"}


def imported(*arguments: str, folder=None) -> set[str]:
    code = (
        "import sys, json, atexit\n"
        "atexit.register(lambda: print(json.dumps(sorted(sys.modules)), file=sys.__stderr__))\n"
        "from surae.cli import main\n"
        f"sys.argv = {['surae', *arguments]!r}\n"
        "main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        check=False,
        text=True,
        timeout=300,
        cwd=folder,
    )
    return {name.split(".")[0] for name in json.loads(done.stderr.splitlines()[-1])}


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["--version"], ["fit", "--model", "muscle", "--help"], ["simulate", "-h"],
        ["validate", "-h"],
     ["demo", "-h"], ["nonsense"], ["fit"], ["fit", "--model", "muscle", "a.csv", "--fixed", "m"]],
)  # fmt: skip
def test_help_and_wrong_use_import_no_library_that_computes(arguments) -> None:
    assert imported(*arguments) & (COMPUTING | {"numpy", "rich"}) == set()


@pytest.mark.parametrize(
    "arguments", [["fit", "--model", "muscle", "none.csv"], ["validate", "f.json", "none.csv"],
                  ["simulate", "none.csv", "--parameters", "p", "--output", "o"]],
)  # fmt: skip
def test_a_wrong_recording_is_found_before_numba_is_imported(arguments, tmp_path) -> None:
    assert imported(*arguments, folder=tmp_path) & COMPUTING == set()


def test_a_fit_imports_nothing_it_does_not_need(made) -> None:
    loaded = imported(
        "fit", "--model", "muscle", str(made / "trial.csv"), "--prepared", "--starts", "1"
    )
    assert "numba" in loaded
    assert loaded & {"matplotlib", "h5py", "joblib", "jinja2", "pydantic"} == set()
