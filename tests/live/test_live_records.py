"""A trial's record: whatever live can say it can read again, and what is damaged is repaired."""

import json
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from streaming import Quick, rehearsed

from surae import api
from surae.base.errors import InputError
from surae.protocol import Protocol, generate
from surae.recording import write_hdf5
from surae.studies import virtual_recording, virtual_subject
from surae_workbench.live.judge import judge
from surae_workbench.live.record import Record, counted, read_record, repaired, said_in
from surae_workbench.live.stream import Stream
from surae_workbench.live.trials import Trials
from surae_workbench.live.xdf import XdfLog

ANY = st.text(st.characters(codec=None), max_size=30)
NUMBER = st.none() | st.floats()
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**12), 10**12) | st.floats() | ANY,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(ANY, inner, max_size=3),
    max_leaves=8,
)
EFFORT = st.sampled_from(["passive", "active", "maximal"])
WORDS = st.sampled_from(["keep", "look", "repeat"])
MARKS = st.lists(st.fixed_dictionaries({"at": st.floats(-1e9, 1e9), "text": ANY}), max_size=4)
BEGUN = {
    "trial": st.integers(1, 10**9 - 1),
    "began": st.none() | ANY,
    "protocol": st.none() | ANY,
    "seconds_asked": NUMBER,
    "effort_asked": st.none() | EFFORT,
    "marks": MARKS,
    "alarms": st.lists(
        st.fixed_dictionaries({"at": NUMBER, "code": ANY, "role": st.none() | ANY, "text": ANY}),
        max_size=3,
    ),
    "split": st.none() | ANY,
    "note": st.none() | ANY,
    "lost_bytes": st.none() | st.integers(0),
    "file": st.none() | ANY.filter(len),
    "recording": st.none() | ANY,
}
JUDGED = {
    "findings": st.lists(st.dictionaries(ANY, PLAIN, max_size=4), max_size=3),
    "seconds": NUMBER,
    "use": st.none() | ANY,
    "effort_judged": st.none() | st.just("unknown") | EFFORT,
    "effort": st.none() | EFFORT,
    "why": st.none() | ANY,
    "grade": st.none() | ANY,
    "vaf": NUMBER,
    "reasons": st.lists(ANY, max_size=3),
    "verdict": WORDS,
    "advice": st.none() | ANY,
    "leg": st.lists(ANY, max_size=3),
    "seconds_to_verdict": NUMBER,
}
STATES = st.fixed_dictionaries(
    {**BEGUN, "state": st.sampled_from(["recording", "being judged", "broken off"])}
) | st.fixed_dictionaries({**BEGUN, **JUDGED, "state": st.just("judged")})


@given(state=STATES)
@settings(max_examples=300, deadline=None)
def test_whatever_live_can_say_of_a_trial_it_can_read(tmp_path_factory, state) -> None:
    path = tmp_path_factory.mktemp("record") / "trial.json"
    record = Record.of(**state)
    record.write(path)
    assert read_record(path, record.trial) == record
    assert len(record.marks) == len(state["marks"])
    json.dumps(record.shown(), allow_nan=False, ensure_ascii=False).encode()


@given(state=STATES, cut=st.floats(0, 1))
@settings(max_examples=100, deadline=None)
def test_a_record_of_which_an_end_is_missing_is_never_taken_for_whole(
    tmp_path_factory, state, cut
) -> None:
    path = tmp_path_factory.mktemp("record") / "trial.json"
    record = Record.of(**state)
    record.write(path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(cut * (len(whole) - 1))])
    with pytest.raises(ValueError):  # noqa: PT011, whatever it says
        read_record(path, record.trial)
    assert repaired(path, record.trial, path).trial == record.trial


def test_marks_and_alarms_are_added_to_those_that_are_there() -> None:
    alarm = {"at": 1.0, "code": "hum", "role": None, "text": "x", "message": "x", "given": {}}
    record = Record.of(trial=1, state="recording")
    for number in range(3):
        record = record.but(
            marks=[*record.marks, {"at": float(number), "text": f"mark {number}"}],
            alarms=[*record.alarms, alarm],
        )
    assert [mark.text for mark in record.marks] == ["mark 0", "mark 1", "mark 2"]
    assert len(record.alarms) == 3


def started(path) -> None:
    log = XdfLog(path)
    log.stream(1, "<info/>")
    for stamp, event in (
        (
            10.0,
            {
                "event": "start",
                "trial": 1,
                "began": "2026",
                "protocol": "sine passive",
                "seconds": 20.0,
                "effort": "passive",
            },
        ),
        (11.0, {"event": "gap"}),
        (12.5, {"event": "mark", "text": "cough"}),
        (13.0, {"event": "alarm", "at": 2.5, "code": "silent", "role": "emg_ta", "text": "x"}),
    ):
        log.words(1, [stamp], [[json.dumps(event)]])
        log.samples(2, np.array([stamp]), np.zeros((1, 3)))
    log.close()


def test_marks_and_what_was_asked_are_in_the_recording_itself(tmp_path) -> None:
    started(tmp_path / "a.xdf")
    said = said_in(tmp_path / "a.xdf")
    assert said["marks"] == [{"at": 2.5, "text": "cough"}]
    assert (said["protocol"], said["effort_asked"], said["seconds_asked"]) == (
        "sine passive",
        "passive",
        20.0,
    )
    assert said["alarms"][0]["role"] == "emg_ta"
    for broken in (b"", b"XDF:", b"XDF:\x04\xff\xff", b"no XDF"):
        (tmp_path / "b.xdf").write_bytes(broken)
        assert said_in(tmp_path / "b.xdf") == {}


@pytest.mark.parametrize("cut", [3, 60])
def test_a_damaged_record_is_repaired_from_what_is_left(lsl, tmp_path, monkeypatch, cut) -> None:
    monkeypatch.setattr("surae_workbench.live.trials.Child", Quick)
    (tmp_path / "mapping.toml").write_text("[channels]\n")
    started(tmp_path / "trial-01.xdf")
    row = tmp_path / "trial-01.json"
    Record.of(trial=1, state="recording", protocol="mine").write(row)
    damaged = row.read_bytes()[:-cut]
    row.write_bytes(damaged)
    trials = Trials(tmp_path, joint=False)
    try:
        told = trials.verdicts[1].result(20)
    finally:
        trials.close()
    assert (told["protocol"], told["effort_asked"]) == ("sine passive", "passive")
    assert told["marks"] == [{"at": 2.5, "text": "cough"}]
    assert (tmp_path / "trial-01.json.damaged-1").read_bytes() == damaged


def test_sound_fields_of_a_damaged_record_are_kept(tmp_path) -> None:
    row = tmp_path / "trial-01.json"
    marks = [{"at": 1.0, "text": "cough"}]
    row.write_text(
        json.dumps(
            {
                "format": 1,
                "trial": 1,
                "state": "splendid",
                "marks": marks,
                "protocol": 3,
                "effort_asked": "passive",
            }
        )
    )
    with pytest.raises(ValueError, match="state"):
        read_record(row, 1)
    record = repaired(row, 1, tmp_path / "none.xdf")
    assert (record.effort_asked, record.protocol, record.marks[0].text) == (
        "passive",
        None,
        "cough",
    )


@pytest.mark.parametrize(
    ("old", "asked", "counts"),
    [
        ({"effort": "unknown", "protocol": "multiple-holds active"}, None, None),
        ({"effort": "unknown", "protocol": "sine passive"}, "passive", "passive"),
        ({"effort": "active", "protocol": "sine active"}, None, "active"),
        ({"effort": "active", "protocol": "sine passive"}, "passive", "active"),
        ({"effort": "maximal", "protocol": "maximum"}, "maximal", "maximal"),
    ],
)
def test_records_of_before_are_read(tmp_path, old, asked, counts) -> None:
    """An earlier surae wrote the effort judged over the one asked for, and called that damaged."""
    row = tmp_path / "trial-01.json"
    row.write_text(
        json.dumps(
            {
                "trial": 1,
                "state": "judged",
                "marks": [{"at": 1.0, "text": ""}],
                "verdict": "keep",
                "use": "fit",
                "seconds": 18.5,
                "grade": "adequate",
                "vaf": 99.0,
                "findings": [],
                "reasons": [],
                "why": "",
                "advice": "",
                "began": "2026",
                "recording": "x.h5",
                **old,
            }
        )
    )
    record = read_record(row, 1)
    assert (record.effort_asked, record.effort, record.effort_judged) == (
        asked,
        counts,
        old["effort"],
    )
    assert (record.seconds, record.verdict, len(record.marks)) == (18.5, "keep", 1)


def test_what_a_record_said_in_other_languages_under_its_older_name_is_read(tmp_path) -> None:
    written = Record.of(
        trial=1, state="judged", verdict="keep", translated={"nl": {"advice": "ja"}}
    )
    path = tmp_path / "trial-01.json"
    written.write(path)
    path.write_text(path.read_text().replace('"translated"', '"told"'))
    assert read_record(path, 1) == written


def test_a_newer_record_is_refused_and_left_where_it_is(lsl, tmp_path) -> None:
    row = tmp_path / "trial-01.json"
    row.write_text('{"format": 2, "trial": 1}')
    with pytest.raises(InputError, match="a newer surae wrote it"):
        Trials(tmp_path, joint=False)
    assert [path.name for path in tmp_path.iterdir() if "damaged" in path.name] == []


def test_what_a_trial_counts_as() -> None:
    assert counted("passive", "unknown") == "passive"
    assert counted("active", "unknown") is None
    assert counted("passive", "active") == "active"
    assert counted("active", "passive") == "passive"
    assert counted("maximal", "active") == "maximal"
    assert counted(None, "active") == "active"
    assert counted("active", None) == "active"


def test_a_relaxed_first_trial_spoils_none_after_it(tmp_path) -> None:
    relaxed = Protocol(profile="sine", task="passive", duration=10.0, rate_hz=1024.0)
    active = Protocol(profile="multiple-holds", task="active", duration=12.0, rate_hz=1024.0)
    leg, told, efforts = virtual_subject(3), [], {}
    for number, (asked, protocol) in enumerate((("passive", relaxed), ("active", active)), 1):
        file = tmp_path / f"in-{number}.h5"
        write_hdf5(file, virtual_recording(leg, generate(protocol), seed=number))
        output = tmp_path / f"trial-0{number}.h5"
        earlier = [str(tmp_path / "trial-01.h5")] if told else []
        told.append(judge(str(file), str(output), earlier, efforts=efforts, instructed=asked))
        record = Record.of(trial=number, state="judged", effort_asked=asked, **told[-1])
        efforts |= {output.stem: record.confirmed_effort} if record.confirmed_effort else {}
    assert (told[0]["effort_judged"], told[0]["effort"]) == ("unknown", "passive")
    assert told[0]["verdict"] != "repeat"
    assert (told[1]["effort"], told[1]["use"]) == ("active", "fit")
    assert told[1]["grade"] is not None
    api.session([str(tmp_path / "trial-01.h5"), str(tmp_path / "trial-02.h5")], efforts=efforts)


@pytest.mark.slow
def test_restarts_leave_every_record_as_it_is(lsl, tmp_path) -> None:
    rehearsed(tmp_path, "--seconds", "7")
    row = tmp_path / "trial-01.json"
    before = row.read_bytes()
    for _ in range(2):
        again = Trials(tmp_path, joint=False)
        again.close()
        assert again.broken == []
        assert row.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir() if "damaged" in path.name] == []
    assert again.trials[1].effort_asked == "active"


HOSTILE = ["\x1b[31mEMG", "a\x01b", "x" * 5000, "tab\there", "gpj\u202evsc", "<&>\"'", "\x9b2J", ""]


@pytest.mark.parametrize("text", HOSTILE)
def test_what_a_stream_says_of_itself_is_cleaned_at_the_door(lsl, tmp_path, text) -> None:
    import pyxdf

    info = lsl.StreamInfo(text or " ", text or " ", 2, 100.0, "double64", "hostile")
    info.set_channel_labels([text, "torque"])
    info.set_channel_units([text, "Nm"])
    info.desc().append_child_value("maker", text)
    stream = Stream.of(2, info)
    for each in (stream.name, stream.kind, *stream.labels, *stream.units):
        assert each.isprintable()
        assert len(each) <= 200
    log = XdfLog(tmp_path / "a.xdf")
    log.stream(2, stream.xml)
    log.clock(2, 10.0, 0.0)
    times = 10.0 + np.arange(300) / 100.0
    log.samples(2, times, np.tile([1.0, 2.0], (300, 1)))
    log.close()
    (read_,), _ = pyxdf.load_xdf(tmp_path / "a.xdf")
    assert float(read_["info"]["nominal_srate"][0]) == 100.0
    names = [channel.column for channel in api.inspect(str(tmp_path / "a.xdf")).channels]
    assert names == stream.columns


def test_a_description_that_is_no_xml_is_made_anew() -> None:
    from surae_workbench.live.stream import _cleaned_xml

    good = "<info><name>a &#1; &amp;</name><desc><x>&#x1b;[2Jy</x></desc></info>"
    assert _cleaned_xml(good) == "<info><name>a ? &amp;</name><desc><x>y</x></desc></info>"
    for bad in (
        "<info>",
        '<!DOCTYPE x [<!ENTITY a "b">]><info>&a;</info>',
        "<a>" * 3 + "x" * 2**20,
        "<info>\x01<name>x</name></info>",
    ):
        assert _cleaned_xml(bad) == ""
    made = Stream(2, "a & b", "x", "here", ["<l>"], ["V"], 100.0, False, "", format=2).described()
    assert re.search("<name>a &amp; b</name>.*double64.*<label>&lt;l&gt;</label>", made)
