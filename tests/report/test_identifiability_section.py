"""What the report says of trade-offs and of what to do."""

from datetime import datetime

import pytest

from surae.assessment import assess
from surae.assessment.identifiability.identified import identifiability
from surae.estimation import fit_problem, make_problem
from surae.protocol import Protocol, generate
from surae.report.identifiability import identifiability_section
from surae.report.rendering import render
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def toe():
    """A fit in which strain and toe force of the tibialis' tendon are estimated together."""
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0
    )
    trial = virtual_trial(virtual_subject(1), generate(protocol), model="muscle-tendon")
    problem = make_problem([trial], "muscle-tendon", free=("dlt_tib", "pt_tib"))
    return fit_problem(problem, starts=1)


def test_the_report_shows_the_trade_off_of_the_tibialis_tendon(toe):
    page = render(toe, assess(toe), versions={}, created=datetime(2026, 1, 5))
    assert "pt_tib up with dlt_tib down and l0_tib up: nearly the same torque" in page
    assert "dlt_tib trades off with pt_tib" in page
    assert "higher forces of the tibialis, past the toe of its tendon" in page


def test_the_rows_are_the_figures(toe):
    identified, said = identifiability(toe), identifiability_section(toe, assess(toe))
    assert [row.name for row in said.rows] == sorted(
        toe.problem.free, key=lambda name: identified.parameters[name].rank
    )
    assert len(said.directions) == 6
    assert (
        said.directions[0].uncertainty == f"{100 * identified.directions[0].uncertainty:.2g}\u00a0%"
    )
    assert said.directions[0].changes.startswith("pt_tib +")
    assert "dlt_tib −" in said.directions[0].changes
    assert said.sets


def test_advice_only_where_something_is_to_be_done(plain):
    said = identifiability_section(plain.result, plain.assessment)
    for row in said.rows:
        assert (row.advice == "") == (row.verdict == "identified"), row
    assert "What this torque tells apart" in plain.words
    assert said.text in plain.words


def test_a_silent_muscle(silent):
    said = identifiability_section(silent.result, silent.assessment)
    rows = {row.name: row for row in said.rows}
    assert (rows["g1"].sensitivity, rows["g1"].alone) == ("0", "—")
    for name in ("g1", "l0_tib"):
        assert f"does not depend on {name}" in rows[name].advice
    assert "infinite" in said.text
