import re
import signal
from collections.abc import Sequence

import pytest

import surae
from surae.cli.progress import Work
from surae.model import get_model

from .conftest import refused

FIT = ("fit", "--model", "muscle", "trial.csv", "--prepared", "--starts", "2")
#: Settles the fit in the valley of the other parameters, but outside what m may be.
BEYOND = ("--bound", "m=2.9:3")


def table(out: str) -> dict[str, str]:
    """Lines of the parameter table by the parameter's name."""
    lines = out.partition("Not identified:")[0].splitlines()
    return {line.split()[0]: line for line in lines if line.strip()}


def test_the_table_shows_every_parameter(run, files) -> None:
    done = run(*FIT)
    assert (done.code, done.err) == (0, "")
    lines = table(done.out)
    for p in get_model("muscle").parameters:
        assert p.unit in lines[p.name]
        rests = p.name[:2] in ("k_", "x0", "l0", "g1", "g2", "g3", "g4") and p.name != "k_rel"
        assert ("identified" in lines[p.name]) is not rests, p.name
        assert p.meaning in lines[p.name]
    assert "muscle model [1.0]" in done.out
    # muscle-space values rest on arms and paths alone, and what is known of the muscles leads
    assert " ".join(done.out.split()).count("Mostly by arms and paths") == 1
    assert done.out.index("passive_exponent_tri") < done.out.index("k_tri ")
    assert "passive_exponent_tri" in done.out.partition("parameter ")[0]
    assert "trial: VAF 99." in done.out
    assert "1921 samples at 48 Hz" in done.out
    assert "IPDE " in done.out
    assert "converged: 2 of 2 starts" in done.out


def test_value_and_interval_have_the_same_decimals_and_hold_each_other(run, files) -> None:
    lines = table(run(*FIT).out)
    value, low, dots, high = lines["k_tri"].split()[1:5]
    assert dots == "…"
    assert float(low) < float(value) < float(high)
    assert len({len(text.partition(".")[2]) for text in (value, low, high)}) == 1
    half = (float(high) - float(low)) / 2
    step = 10.0 ** -len(value.partition(".")[2])
    assert 10 <= half / step < 300  # at least two digits of the half-width, at most three


@pytest.mark.parametrize(("columns", "widest"), [("80", 80), ("200", 120)])
def test_the_table_fits_the_terminal(run, files, monkeypatch, columns, widest) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    out = run(*FIT, *BEYOND).out
    rows = out.split("\n\n")
    assert max(map(len, rows[1].splitlines())) <= widest
    assert max(map(len, rows[2].splitlines())) <= int(columns)
    assert all(line == line.rstrip() for line in out.splitlines())
    assert ("mass of foot" in out) == (columns == "200")
    assert len(rows[1].splitlines()) == 2 + 15  # one line for each parameter


def test_what_is_not_identified_is_explained_below_the_table(run, files) -> None:
    out = run(*FIT, *BEYOND, "--fixed", "beta=1").out
    assert "at-bound" in table(out)["m"]
    assert "—" in table(out)["m"]
    assert "fixed" in table(out)["beta"]
    notes = out[out.index("Not identified:") :].splitlines()
    assert any(re.match("m(, .*)?: at its lower bound", line) for line in notes)
    assert not any(line.startswith("beta") for line in notes[: notes.index("")])
    assert "at-bounds: " in out


def test_colours_only_on_a_terminal_that_wants_them(run, files, monkeypatch) -> None:
    assert "\x1b" not in run(*FIT).out
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b[32m" in run(*FIT).out
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b[32m" not in run(*FIT).out


@pytest.mark.usefixtures("undrawn")
def test_outputs_appear_and_load(run, files) -> None:
    done = run(*FIT, "--output", "ä b.json", "--report", "r.html", "--seed", "7")
    assert done.code == 0
    assert "fit: ä b.json" in done.out
    assert "report: r.html" in done.out
    fit = surae.load(files / "ä b.json")
    assert fit.result.seed == 7
    assert fit.status == "converged"
    again = surae.fit(files / "trial.csv", "muscle", prepared=True, starts=1, seed=7)
    assert again.values == fit.values
    page = (files / "r.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>") or page.startswith("<!doctype html>")
    assert "l0_tri" in page


def test_a_muscle_without_emg_is_fine_when_its_weight_is_fixed(run, edit) -> None:
    def drop(header: list[str], rows: Sequence[list[str]]) -> None:
        column = header.index("emg_ta_V")
        for row in [header, *rows]:
            del row[column]

    edit("no ta.csv", drop)
    arguments = ("fit", "no ta.csv", "--model", "muscle", "--prepared", "--starts", "1")
    assert run(*arguments).code == 2
    done = run(*arguments, "--fixed", "g1=0")
    assert done.code in (0, 1)
    assert "fixed" in table(done.out)["g1"]


def test_a_fit_that_fails_is_shown_written_and_exit_1(run, files, monkeypatch) -> None:
    real = surae.api.fit_inputs

    def cut_short(*arguments, **options):
        fit = real(*arguments, **options)
        object.__setattr__(fit.result, "status", "failed")
        object.__setattr__(fit.result, "message", "no minimum reached")
        return fit

    monkeypatch.setattr("surae.api.fit_inputs", cut_short)
    done = run(*FIT, "--output", "f.json")
    assert done.code == 1
    assert done.err == "surae: the fit failed: no minimum reached\n"
    assert "k_tri" in done.out
    assert surae.load(files / "f.json").status == "failed"


def test_ctrl_c_keeps_the_best_so_far(run, files, monkeypatch) -> None:
    def press(self: Work, done: int, total: int, best: float) -> None:
        if done == 3:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Work, "starts", press)
    done = run(*FIT[:-1], "50", "--output", "f.json")
    assert done.code == 130
    assert done.err == "surae: stopped by the user; the best fit so far is shown and written\n"
    assert "k_tri" in done.out
    fit = surae.load(files / "f.json")
    assert [start.outcome for start in fit.result.solution.starts][-1] == "interrupted"
    assert len(fit.result.solution.starts) == 4
    assert "stopped by the user in start 4 of 50" in fit.message
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_odd_names_are_shown_as_they_are(run, files) -> None:
    odd = files / "[red]x[!b] é 你.csv"
    (files / "trial.csv").rename(odd)
    done = run(
        "fit",
        "--model",
        "muscle",
        odd.name,
        "--prepared",
        "--starts",
        "1",
        "--output",
        "[b]\nx.json",
    )
    assert done.code == 0
    assert f"{odd.stem}: VAF" in done.out
    assert "fit: [b] x.json\n" in done.out
    assert (files / "[b]\nx.json").is_file()


def test_a_raw_recording_of_a_dynamometer(run, shared) -> None:
    done = run(
        "fit", "--model", "muscle", shared / "dynamometer" / "PL_50_01.toml", "--starts", "1"
    )
    assert done.code in (0, 1)
    assert "isokinetic dorsiflexion, tibialis anterior EMG only: VAF 9" in done.out
    assert "fixed" in table(done.out)["g2"]


def test_a_figure_for_a_paper(run, files) -> None:
    done = run(*FIT, "--figure", "f.pdf", "--width", "120")
    assert done.code == 0
    assert done.out.endswith("figure: f.pdf\n")
    assert (files / "f.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--figure", "f.gif"), "--figure f.gif must end in .svg, .pdf or .png"),
        (("--figure", "trial.csv"), "must end in"),
        (("--figure", "f.svg", "--width", "3"), "3.0 is not in the range 40.0<=x<=500.0"),
        (("--figure", "f.svg", "--report", "f.svg"), ".html or .pdf"),
        (("--figure", "f.pdf", "--report", "f.pdf"), "is the file of"),
    ],
)
def test_a_figure_that_cannot_be_made_is_refused_before_the_fit(run, files, more, said) -> None:
    done = run(*FIT, *more)
    refused(done, said)
    assert not (files / "f.pdf").exists()
