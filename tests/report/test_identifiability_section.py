"""What the report says of trade-offs and of what to do."""

from datetime import datetime

import pytest

from surae.inference import AssessedFit, assess, fit_problem, make_problem
from surae.inference.identifiability.identified import identifiability
from surae.protocol import Protocol, generate
from surae.report.fit import fit_report
from surae.report.sections import identifiability_section
from surae.studies import virtual_subject, virtual_trial

from . import parts


@pytest.fixture(scope="module")
def toe():
    """A fit in which strain and toe force of the tibialis' tendon are estimated together."""
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0
    )
    trial = virtual_trial(virtual_subject(1), generate(protocol), model="muscle-tendon")
    problem = make_problem([trial], "muscle-tendon", free=("dlt_tib", "pt_tib"))
    return fit_problem(problem, starts=1)


@pytest.mark.usefixtures("undrawn")
def test_the_report_shows_the_trade_off_of_the_tibialis_tendon(toe):
    page = fit_report(
        AssessedFit(toe, assess(toe)), versions={}, created=datetime(2026, 1, 5)
    ).page()
    assert "pt_tib up with dlt_tib down and l0_tib up: nearly the same torque" in page
    assert "dlt_tib trades off with pt_tib" in page
    assert "higher forces of the tibialis, past the toe of its tendon" in page


def test_the_rows_are_the_figures(toe):
    identified, section = (
        identifiability(toe),
        identifiability_section(AssessedFit(toe, assess(toe))),
    )
    assert list(parts.rows(section, 1)) == sorted(
        toe.problem.free, key=lambda name: -identified.parameters[name].sensitivity
    )
    directions = list(parts.rows(section).values())
    assert len(directions) == 6
    known = f"{100 * identified.directions[0].uncertainty:.2g}\u00a0%"
    assert directions[0]["Known to ±"].text == known
    change = directions[0]["A change that this torque cannot show"].text
    assert change.startswith("pt_tib +")
    assert "dlt_tib −" in change
    assert "Condition number of the scaled information matrix: " in parts.text(section)


def test_advice_only_where_something_is_to_be_done(plain):
    section = identifiability_section(plain)
    for row in parts.rows(section, 1).values():
        identified = row["Verdict"].badge[1] == "identified"
        assert (row["What to do"].text == "") == identified, row
    assert "Which parameters this torque separates" in plain.words
    assert section.blocks[0].text in plain.words


def test_a_silent_muscle(silent):
    section = identifiability_section(silent)
    rows = parts.rows(section, 1)
    assert (rows["g1"]["Influence δ"].text, rows["g1"]["SEM alone"].text) == ("0", "—")
    for name in ("g1", "l0_tib"):
        assert f"does not depend on {name}" in rows[name]["What to do"].text
    assert "infinite" in section.blocks[0].text
