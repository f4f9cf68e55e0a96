"""Help and errors come at once: nothing that computes is imported for them."""

import json
import subprocess
import sys

COMPUTING = {"numba", "scipy", "matplotlib", "h5py", "joblib", "jinja2", "pydantic"}


def imported(*commands: list[str], folder=None) -> set[str]:
    """Libraries that these commands import, one after the other in a process of their own."""
    code = (
        "import sys, json\n"
        "from surae.cli import main\n"
        f"for words in {commands!r}:\n"
        "    sys.argv = ['surae', *words]\n"
        "    try:\n"
        "        main()\n"
        "    except SystemExit:\n"
        "        pass\n"
        "print(json.dumps(sorted(sys.modules)), file=sys.__stderr__)\n"
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


def test_help_and_wrong_use_import_no_library_that_computes() -> None:
    commands = (
        ["--help"],
        ["--version"],
        ["fit", "--model", "muscle", "--help"],
        ["simulate", "-h"],
        ["validate", "-h"],
        ["demo", "-h"],
        ["protocol", "--help"],
        ["nonsense"],
        ["fit"],
        ["fit", "--model", "muscle", "a.csv", "--fixed", "m"],
    )
    assert imported(*commands) & (COMPUTING | {"numpy", "rich"}) == set()


def test_what_is_wrong_is_found_before_numba_is_imported(tmp_path) -> None:
    commands = (
        ["fit", "--model", "muscle", "none.csv"],
        ["validate", "f.json", "none.csv"],
        ["simulate", "none.csv", "--parameters", "p", "--output", "o"],
        ["protocol", "sine", "--output", "p.txt"],
    )
    assert imported(*commands, folder=tmp_path) & COMPUTING == set()


def test_a_fit_imports_nothing_it_does_not_need(made) -> None:
    loaded = imported(
        ["fit", "--model", "muscle", str(made / "trial.csv"), "--prepared", "--starts", "1"]
    )
    assert "numba" in loaded
    assert loaded & {"matplotlib", "h5py", "joblib", "jinja2", "pydantic"} == set()


def test_ctrl_c_while_it_is_being_imported_is_one_line() -> None:
    code = (
        "import sys\n"
        "class Stop:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'click': raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Stop())\n"
        "from surae.__main__ import run\n"
        "run()\n"
    )
    made = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (made.returncode, made.stderr) == (130, "surae: stopped by the user\n")
