import pytest

from surae_thesis import section as thesis
from surae_thesis.claims import Claim, NotThereError, Ruling, judge
from surae_thesis.section import Context, Result, Section


def rule(value: float) -> Ruling:
    if not value:
        raise NotThereError("Nobody measured it.")
    return Ruling(value > 1, f"{value:g}")


CLAIM = Claim(
    id="rises",
    source="3.1",
    statement="It rises.",
    number="2",
    says="It rose.",
    rule="Above 1.",
    ours=rule,
    why="The seed is small.",
)


def small(context: Context) -> Result:
    """As large as its seed; stops once, with what it has kept."""
    context.progress("small", 0, 1)
    kept = context.store("small")
    if context.quick and not kept.exists():
        kept.write_text("half")
        raise KeyboardInterrupt
    return Result(findings=tuple(judge(CLAIM, {"": value}) for value in (context.seed, 0)))


@pytest.fixture(autouse=True)
def section(monkeypatch) -> None:
    """One small section instead of those that take minutes."""
    only = Section(name="small", title="Small [part]", source="3.1", run=small)
    monkeypatch.setattr(thesis, "SECTIONS", (only,))


def test_it_shows_every_verdict_and_where_the_page_is(run, tmp_path) -> None:
    done = run("reproduce", "--workers", 1)
    assert (done.code, done.err) == (0, "")
    assert "Small [part] (3.1)" in done.out
    assert "differs" in done.out
    assert "0 holds, " in done.out
    assert "1 differs, 0 not tested by this, 1 cannot be checked" in done.out
    assert "page: reproduction/reproduction.html" in done.out
    assert "Nobody measured it." in (tmp_path / "reproduction" / "verdicts.md").read_text()


def test_the_seed_reaches_the_section(run) -> None:
    assert "1 holds, " in run("reproduce", "--seed", 7, "--workers", 1).out


def test_a_stopped_run_says_that_it_can_go_on_and_does(run, tmp_path) -> None:
    done = run("reproduce", "--quick", "--output", "out", "--workers", 1)
    assert done.code == 130
    assert done.err == (
        "surae: stopped by the user; what is computed is kept in out: run the same command to go "
        "on\n"
    )
    assert not (tmp_path / "out" / "reproduction.html").exists()
    assert run("reproduce", "--quick", "--output", "out", "--workers", 1).code == 0
    assert "quick: a part of the fits" in (tmp_path / "out" / "reproduction.html").read_text()


def test_the_verdicts_are_written_for_the_docs_too(run, tmp_path) -> None:
    done = run("reproduce", "--workers", 1, "--markdown", "copy.md")
    assert done.code == 0
    assert (tmp_path / "copy.md").read_text() == (
        tmp_path / "reproduction" / "verdicts.md"
    ).read_text()


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--only", "smal"], "no section 'smal'; use one of: small"),
        (["--seed", "-1"], "-1 is not in the range"),
        (["--seed", "1.5"], "'1.5' is not a valid integer"),
        (["--workers", "0"], "0 is not in the range 1<=x<=1000"),
        (["--output", ""], "--output is empty"),
        (["--output", "file"], "cannot write into the folder file"),
        (["--markdown", "no/copy.md"], "there is no folder"),
        (["extra"], "unexpected extra argument"),
    ],
)
def test_wrong_use_is_one_line_and_leaves_nothing(run, tmp_path, arguments, complaint) -> None:
    (tmp_path / "file").write_text("")
    done = run("reproduce", *arguments)
    assert done.code == 2
    assert complaint in done.err
    assert done.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
