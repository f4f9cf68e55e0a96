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


def test_readme_and_page_give_these_counts() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8").split("\n##")[0]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (line,) = [line for line in readme.splitlines() if "reproduce the thesis?" in line]
    for text in (page, line):
        for number in (len(EVERY), *(COUNTS[verdict] for verdict in VERDICTS)):
            assert not number or re.search(rf"\b{number}\b", text)
        assert re.search(rf"\b{COUNTS['differs']}\s+differ", text)
    rows = re.findall(r"^\| `\w+` \|.*$", page, flags=re.MULTILINE)
    assert len(rows) == len(SAID)
    for row, section in zip(rows, SAID, strict=True):
        differs = sum(said.startswith("differs") for said in section)
        plain = [section.count(v) for v in ("holds", "same direction, smaller", "calibrated")]
        numbers = [int(cell) for cell in row.split("|") if cell.strip().isdigit()]
        under = len(section) - differs - sum(plain)
        assert numbers == [plain[0], under, *plain[1:], differs]


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
    beside = {"A chirp of 0.3 rad", "The size of a standard error"}  # no claim that differs
    assert len(set(paragraphs) - beside) == EVERY.count("differs: unexplained")


def test_numbers_of_the_findings_are_those_of_the_table() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8").split("\n##")[0]
    findings = " ".join(page.split())
    for text in re.findall(r"^\*\*(?:A low SEM|Solved|Table 2).*$", TABLE, flags=re.MULTILINE):
        for number in re.findall(r"[\d.]+ %|\d+ to \d+ Nm", text):
            assert re.search(rf"(?<![\d.]){re.escape(number)}", findings), number
