"""What README and the page on the reproduction say of its verdicts is what its table says."""

import re
from collections import Counter

from docs.pages import ROOT
from surae_thesis.claims import CAUSES, VERDICTS

TABLE = (ROOT / "docs" / "reproduction-table.md").read_text(encoding="utf-8")
#: The verdicts of the table, in full, by section.
SAID = [
    re.findall(r"\*\*([^*]+)\*\* \|$", part, flags=re.MULTILINE)
    for part in TABLE.split("\n## ")[1:]
]
EVERY = [said for section in SAID for said in section]
COUNTS = Counter(
    "differs"
    if said.startswith("differs")
    else "holds with the thesis's integrator"
    if "integrator" in said
    else "holds under a reading"
    if said.startswith("holds under")
    else said
    for said in EVERY
)
#: How many claims differ for each cause.
DIFFER = [EVERY.count(f"differs: {cause}") for cause in CAUSES]


def test_the_table_counts_its_own_rows() -> None:
    (line,) = re.findall(r"^Verdicts: (.*)\.$", TABLE, flags=re.MULTILINE)
    assert line == ", ".join(f"{COUNTS[verdict]} {verdict}" for verdict in VERDICTS)
    assert set(COUNTS) <= set(VERDICTS)
    given = re.findall(r"\d+", TABLE.split("Of those that differ")[1].split("\n")[0])
    assert list(map(int, given)) == [count for count in DIFFER if count]


def test_everything_that_differs_says_why() -> None:
    assert sum(DIFFER) == COUNTS["differs"]


#: How texts say each count: a number, and then this.
SAYINGS = {
    "holds": r"\s+hold\b",
    "holds under a reading": r"\s+(?:hold\s+under|more\s+under)",
    "holds with the thesis's integrator": r"\s+(?:hold\s+)?with\s+its",
    "same direction, smaller": r"\s+have\s+its\s+direction",
    "calibrated": r"\s+(?:were calibrated|cannot hold)",
    "differs": r"\s+differ",
    "not tested by this": r"\s+are\s+not\s+tested",
}


def test_readme_page_and_paper_give_these_counts() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8").split("\n##")[0]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (line,) = [line for line in readme.splitlines() if "reproduce the thesis?" in line]
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    (claims,) = [part for part in paper.split("\n\n") if "computes its claims again" in part]
    for text in (page, line, claims.split("computes its claims again")[1]):
        assert re.search(rf"\b{len(EVERY)}\b", text)
        for verdict, saying in SAYINGS.items():
            if COUNTS[verdict]:
                assert re.search(rf"\b{COUNTS[verdict]}{saying}", text), (verdict, text)
    rows = re.findall(r"^\| `\w+` \|.*$", page, flags=re.MULTILINE)
    assert len(rows) == len(SAID)
    for row, section in zip(rows, SAID, strict=True):
        differs = sum(said.startswith("differs") for said in section)
        verdicts = ("holds", "same direction, smaller", "calibrated", "not tested by this")
        plain = [section.count(v) for v in verdicts]
        numbers = [int(cell) for cell in row.split("|") if cell.strip().isdigit()]
        under = len(section) - differs - sum(plain)
        assert numbers == [plain[0], under, *plain[1:3], differs, plain[3]]


def test_the_list_of_before_and_after_has_the_verdicts_of_the_table() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")
    listed = re.findall(
        r"^\| (.+?) \| [^|]+ \| ([^|]+) \|$", page.split("| now |")[1], re.MULTILINE
    )
    now = {claim: said.strip("*") for claim, said in listed if "---" not in claim}
    rows = re.findall(r"^\| ([A-Za-z].*?\.) \(.*\*\*([^*]+)\*\* \|$", TABLE, flags=re.MULTILINE)
    assert now == {claim.replace("\\", ""): said.replace("\\", "") for claim, said in rows}
    assert len(now) == len(EVERY) == 114


def test_each_unexplained_claim_has_a_paragraph_and_causes_are_counted() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")
    head, why = page.split("\n##")[0], page.split("## What differs, and why")[1].split("\n## ")[0]
    found = re.search(
        r"(\d+) differ: (\d+) by .*?, (\d+) by .*?, (\d+)\s+because .*?, (\d+) we", head, re.DOTALL
    )
    assert found is not None
    assert list(map(int, found.groups())) == [COUNTS["differs"], *filter(None, DIFFER)]
    paragraphs = re.findall(r"^\*\*([A-Z].*?)\*\*", why, flags=re.MULTILINE)
    # No claims that differ.
    beside = {
        "A chirp of 0.3 rad",
        "The size of a standard error",
        "VAF of the tendon model",
    }
    assert len(set(paragraphs) - beside) == EVERY.count("differs: unexplained")


def test_numbers_of_the_findings_are_those_of_the_table() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8").split("\n##")[0]
    findings = " ".join(page.split())
    for text in re.findall(r"^\*\*(?:A low SEM|Solved|Table 2).*$", TABLE, flags=re.MULTILINE):
        for number in re.findall(r"[\d.]+ %|\d+ to \d+ Nm", text):
            assert re.search(rf"(?<![\d.]){re.escape(number)}", findings), number
