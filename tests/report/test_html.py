import base64
import hashlib
import json
import re
from dataclasses import replace
from datetime import datetime
from html.parser import HTMLParser

import numpy as np
import pytest

from surae.report.fit import fit_report
from surae.report.traces import signals_of, traces_of
from surae.report.wording import adequacy_words
from undrawn import blank_figures

HOSTILE = '"><script>alert(1)</script>'
_EXTERNAL = ("src", "href", "action", "data", "poster", "srcset", "background")


class Page(HTMLParser):
    """Tags with their attributes, and the text of the page."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.text = [], ""
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text += data

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.mark.parametrize("name", ["joint", "silent"])
def test_nothing_is_asked_of_the_outside(name, request):
    page = request.getfixturevalue(name).words
    parsed = Page(page)
    for _, attributes in parsed.tags:
        for key in _EXTERNAL:
            value = attributes.get(key)
            assert value is None or value.startswith(("data:image/", "#"))
    said = re.sub(r"/\*!.*?\*/", "", page, flags=re.DOTALL)  # whose library it is, kept as asked
    assert not re.search(r"url\(|@import|https?://|fetch\(|XMLHttpRequest|WebSocket", said)
    assert not {"link", "iframe", "object", "embed", "base", "form"} & {
        tag for tag, _ in parsed.tags
    }
    policies = [m["content"] for m in parsed.all("meta") if "http-equiv" in m]
    data, *scripts = re.findall(r"<script([^>]*)>(.*?)</script>", page, re.DOTALL)
    assert data[0] == ' type="application/json" id="signals"'
    hashes = " ".join(
        f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
        for _, text in scripts
    )
    assert len(scripts) == 2
    assert policies == [
        f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {hashes}"
    ]


def test_all_parameters_verdicts_and_reasons_are_on_the_page(joint):
    text = " ".join(Page(joint.words).text.split())
    for p in joint.assessment.parameters.values():
        assert p.name in text
        assert p.meaning in text
        assert " ".join(p.note.split()) in text
    for file in joint.result.problem.inputs:
        assert file.files[0].sha256 in text
    words = adequacy_words(joint.assessment.adequacy)
    assert words.reasons  # f0 lies at a bound
    for said in (words.sentence, *words.reasons):
        assert text.index(said) < text.index("Parameters by verdict")
    for expected in ("1.2.3", "2026-01-05 14:03", joint.result.message):
        assert expected in text


def test_names_are_text(joint):
    parsed = Page(joint.words)
    assert HOSTILE not in joint.words
    assert "</script>" not in signals_of(traces_of(joint.result))
    assert parsed.text.count(HOSTILE) >= 4  # title, heading, file, step
    assert len(parsed.all("script")) == 3  # the data, the library, its use


def test_the_plots_hold_the_signals_as_they_are(joint):
    """The first line of a page: measured torque, of which a step is a part in 65535."""
    for traces, shown in zip(
        traces_of(joint.result), json.loads(signals_of(traces_of(joint.result))), strict=True
    ):
        assert shown["name"] == traces.name
        index = np.frombuffer(base64.b64decode(shown["index"]), "<u4")
        assert shown["start"] + index / shown["rate"] == pytest.approx(traces.time[index])
        title, unit, lines = shown["panels"][0]
        assert (title, unit, [line[0] for line in lines]) == (
            "Torque",
            "Nm",
            ["measured", "modelled"],
        )
        for (_, low, high, steps), signal in zip(
            lines, (traces.measured, traces.modelled), strict=True
        ):
            values = low + (high - low) * np.frombuffer(base64.b64decode(steps), "<u2") / 65534
            assert values == pytest.approx(signal[index], abs=(high - low) / 65534)


def test_what_is_not_finite_is_a_gap_and_emg_not_recorded_no_line(joint):
    traces = traces_of(joint.result)[0]
    broken = traces.modelled.copy()
    broken[5:] = np.nan
    (shown,) = json.loads(
        signals_of([replace(traces, modelled=broken, missing_emg=("ta", "gl", "sol"))])
    )
    steps = np.frombuffer(base64.b64decode(shown["panels"][0][2][1][3]), "<u2")
    assert (steps[:5] < 65535).all()
    assert (steps[5:] == 65535).all()
    assert [line[0] for line in shown["panels"][-1][2]] == ["GM"]


def test_images_and_tables_can_be_read_without_seeing(joint):
    parsed = Page(joint.page)
    assert len(joint.page.encode()) < 1_000_000
    images = parsed.all("img")
    assert len(images) == 7  # the first screen's two, two of each recording, and the heat map
    assert all(image["src"].startswith("data:image/") for image in images)
    assert all(len(image["alt"]) > 40 for image in images)
    assert all(cell.get("scope") in ("col", "row", "rowgroup") for cell in parsed.all("th"))
    assert all(drawing.get("aria-label") for drawing in parsed.all("svg"))
    assert len(parsed.all("caption")) == len(parsed.all("table"))
    assert parsed.all("html") == [{"lang": "en"}]
    identifiers = [a["id"] for _, a in parsed.tags if "id" in a]
    assert len(set(identifiers)) == len(identifiers)
    assert {a["aria-labelledby"] for _, a in parsed.tags if "aria-labelledby" in a} <= set(
        identifiers
    )


@pytest.mark.slow
def test_the_same_fit_gives_the_same_file(plain, tmp_path):
    arguments = {"versions": {"surae": "1.2.3"}, "created": datetime(2026, 1, 5, 14, 3)}
    path = tmp_path / "report.html"
    with blank_figures():
        fit_report(plain, **arguments).write(path)
        assert path.read_text(encoding="utf-8") == plain.words
        created = datetime(2027, 1, 5, 14, 3)
        later = fit_report(plain, versions={}, created=created).page()
    assert "2027-01-05" in later
