"""Layouts of laboratories' files: read with names, units, times and trials, or said plainly.

Every file is made here; each kind has others beside the one that was reported.
"""

import io

import layouts as made
import numpy as np
import pytest
from layouts import ANGLE, DATA, EMG, MUSCLES, OURS, RATE, THEIRS, TIME, TORQUE, N

from surae.api import data_files_below, inspect_trials, nothing_mapped, read_trials
from surae.base.errors import InputError
from surae.recording import inspect, mapping_text, read
from surae.recording.mapping import Description
from surae.recording.reading import is_mapping, open_mapping
from surae.recording.source import open_source
from surae.recording.trials import SeveralTrialsError


def mapped(path, *, settle=()):
    """The recording that the mapping of an inspection reads, once its open lines are settled."""
    text = mapping_text(inspect(path), path.parent)
    for old, new in settle:
        assert old in text, text
        text = text.replace(old, new)
    toml = path.with_name("map.toml")
    toml.write_text(text, encoding="utf-8")
    return read(toml)


def holds(recording, *, start=0.0, rate=RATE):
    """The trial is there, in SI units, at the times that the file says."""
    angle = recording.channels["angle"]
    assert angle.rate_hz == pytest.approx(rate, rel=1e-3)
    assert angle.time[0] == pytest.approx(start, abs=1e-6)
    np.testing.assert_allclose(np.degrees(angle.values), ANGLE, atol=1e-3)
    np.testing.assert_allclose(recording.channels["torque"].values, TORQUE, atol=1e-3)
    np.testing.assert_allclose(1e3 * recording.channels["emg_sol"].values, EMG[:, 2], atol=1e-5)


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        *(("Czas [s]", 1.0), ("Zeit (ms)", 1e3), ("Tempo (s)", 1.0), ("Elapsed", 1.0)),
        *(("Time_us", 1e6), ("millis", 1e3), ("Seconds", 1.0), ("Time (min)", 1 / 60)),
        *(("tijd [us]", 1e6), ("Timestamp (ns)", 1e9), ("Temps (s)", 1.0), ("t", 1.0)),
    ],
)
def test_times_are_known_by_name_in_any_unit(file, name, factor):
    path = file(made.timed(name, TIME * factor))
    recording = mapped(path)
    holds(recording)


@pytest.mark.parametrize(
    ("name", "factor", "unit"),
    [("", 1.0, "s"), ("lp", 1e3, "ms"), ("Stempel", 1e6, "us"), ("k2", 1e9, "ns")],
)
def test_times_are_offered_by_their_shape_where_no_name_says_them(file, name, factor, unit):
    rng = np.random.default_rng(3)
    uneven = TIME + 0.0001 * rng.uniform(size=N)
    path = file(made.timed(name, np.round(uneven * factor, 4)))
    found = inspect(path)
    (clock,) = found.clocks.values()
    assert (clock.column, clock.unit) == (name or "column 1", unit)
    recording = mapped(path)
    np.testing.assert_allclose(recording.channels["angle"].time, uneven, atol=2e-4)
    with pytest.raises(InputError, match="may be the time in"):
        read(path)


@pytest.mark.parametrize("column", ["Frame", "n"])
def test_a_count_of_samples_is_no_time(file, column):
    path = file(made.timed(column, np.arange(N)))
    found = inspect(path)
    assert not found.clocks
    assert all("counts the samples" in c.remark for c in found.roles.values())


@pytest.mark.parametrize(
    ("line", "time"),
    [
        ('time = "when"', TIME),
        ('time = { column = "when", unit = "ms" }', TIME * 1e3),
        ('time = { column = "when", unit = "us" }', TIME * 1e6),
    ],
)
def test_a_mapping_names_the_column_of_times(file, line, time):
    file(made.timed("when", time, names=OURS))
    channels = "".join(
        f'[channels.{role}]\nfile = "trial.csv"\ncolumn = "{name}"\n'
        for role, name in zip(("angle", "torque", "emg_sol"), (*OURS[:2], OURS[4]), strict=True)
    )
    fixed = "fixed = { g1 = 0.0, g2 = 0.0, g4 = 0.0 }\n"
    toml = file(f"{line}\n{fixed}{channels}", "map.toml")
    holds(read(toml))
    toml.write_text(toml.read_text().replace("when", "then"))
    with pytest.raises(InputError, match=r"time: .*no column 'then'"):
        read(toml)


def test_t_and_T_are_time_and_torque(file):
    path = file(made.text(("t", "theta (deg)", "T (Nm)"), (TIME, ANGLE, TORQUE)))
    found = inspect(path)
    assert found.roles["torque"].column == "T (Nm)"
    assert found.roles["torque"].rate_hz == pytest.approx(RATE, rel=1e-3)
    both = file(made.text(("t", "theta_deg", "T"), (TIME, ANGLE, TORQUE)), "both.csv")
    assert "T" in [c.column for c in inspect(both).channels]


@pytest.mark.parametrize(
    "name", ["Zyklus (%)", "GC %", "Ciclo de marcha (%)", "% Gangzyklus", "Gait cycle (%)", "x (%)"]
)
def test_percent_of_a_movement_is_no_time_in_any_language(file, name):
    some = np.linspace(0, N - 1, 101).astype(int)
    path = file(made.text((name, *THEIRS[:2]), (np.arange(101), DATA[some, :2])))
    with pytest.raises(InputError, match="in percent has no speed"):
        inspect(path)


@pytest.mark.parametrize("encoding", ["cp1250", "iso8859_2"])
def test_letters_of_central_europe_are_decoded_and_said(file, encoding):
    names = ("Kąt [°]", "Moment siły [Nm]", *(f"{m} [mV]" for m in MUSCLES))
    whole = made.timed("Czas [s]", names=names, between=";", decimal=",")
    path = file(whole, encoding=encoding)
    found = inspect(path)
    assert found.roles["angle"].column == "Kąt [°]"
    assert found.roles["torque"].column == "Moment siły [Nm]"
    assert all(f"read as {encoding}" in c.remark for c in found.channels)
    holds(mapped(path))


@pytest.mark.parametrize("again", [True, False])
@pytest.mark.parametrize(
    ("column", "labels"),
    [
        ("trial", ("1", "2", "3")),
        ("Versuch", ("a", "b")),
        ("Rep #", ("4", "7", "9")),
        ("condition", ("slow", "fast")),
    ],
)
def test_trials_under_each_other_are_told_apart_by_their_column(file, column, labels, again):
    path = file(made.trials(column, labels, again=again))
    if column == "condition" and not again:
        return  # neither its name nor the times say that it tells trials apart
    found = inspect(path)
    (trials,) = found.trials.values()
    assert (trials.how, trials.column, trials.names) == ("column", column, labels)
    assert found.roles["angle"].n == N // 2
    with pytest.raises(SeveralTrialsError, match=f"{len(labels)} trials in one file"):
        read(path)
    toml = path.with_name("map.toml")
    toml.write_text(mapping_text(found, path.parent))
    with pytest.raises(SeveralTrialsError, match="each a recording of its own"):
        read(toml)
    each = read_trials(toml)
    assert [one.name for one in each] == [f"trial-{label}" for label in labels]
    for k, one in enumerate(each):
        angle = one.channels["angle"]
        np.testing.assert_allclose(np.degrees(angle.values), ANGLE[::2] + k, atol=1e-3)
        assert (np.diff(angle.time) > 0).all()
    chosen = toml.read_text().replace(
        f'column = "{column}" }}', f'column = "{column}", index = 2 }}'
    )
    toml.write_text(chosen)
    np.testing.assert_allclose(
        np.degrees(read(toml).channels["angle"].values), ANGLE[::2] + 1, atol=1e-3
    )


def test_trials_without_a_column_are_told_apart_by_times_that_fall_back(file):
    rows = made.timed("time_s", names=OURS).splitlines()
    path = file("\n".join([rows[0], *rows[1:], *rows[1:]]) + "\n")
    with pytest.raises(SeveralTrialsError, match="the time falls back once"):
        read(path)
    toml = file(mapping_text(inspect(path), path.parent), "map.toml")
    first, second = read_trials(toml)
    holds(first)
    holds(second)
    joining = (
        toml.read_text()
        .replace('trial = { index = "*" }', "")
        .replace('unit = "deg"', 'unit = "deg"\nrate_hz = 500.0')
    )
    toml.write_text(joining)
    with pytest.raises(InputError, match="rate_hz would join them"):
        read(toml)


def test_blocks_with_their_names_repeated_are_trials(file):
    block = made.timed("time_s", names=OURS)
    path = file(f"Trial 1\n{block}\nTrial 2\n{block}")
    found = inspect(path)
    (trials,) = found.trials.values()
    assert len(trials.names) == 2
    toml = file(mapping_text(found, path.parent), "map.toml")
    for one in read_trials(toml):
        holds(one)


def test_rows_out_of_order_are_no_trials(file):
    rows = made.timed("time_s", names=OURS).splitlines()
    rows[10], rows[11] = rows[11], rows[10]
    with pytest.raises(InputError, match="sort the rows"):
        read(file("\n".join(rows) + "\n"))


def test_sheets_and_groups_are_trials(file, tmp_path):
    import h5py
    import openpyxl

    book = openpyxl.Workbook()
    for k, title in enumerate(("slow", "fast")):
        sheet = book.active if k == 0 else book.create_sheet()
        sheet.title = title
        sheet.append(["time_s", *OURS])
        for i in range(0, N, 4):
            sheet.append([TIME[i], *(DATA[i] + k).tolist()])
    buffer = io.BytesIO()
    book.save(buffer)
    path = file(buffer.getvalue(), "book.xlsx")
    found = inspect(path)
    (trials,) = found.trials.values()
    assert (trials.how, trials.names, trials.sheets) == ("group", ("slow", "fast"), True)
    toml = file(mapping_text(found, tmp_path), "map.toml")
    each = read_trials(toml)
    assert [one.name for one in each] == ["book-slow", "book-fast"]
    np.testing.assert_allclose(np.degrees(each[1].channels["angle"].values), ANGLE[::4] + 1)
    toml.write_text(toml.read_text().replace('sheet = "*"', 'sheet = "fast"'))
    np.testing.assert_allclose(np.degrees(read(toml).channels["angle"].values), ANGLE[::4] + 1)

    with h5py.File(tmp_path / "groups.h5", "w") as store:
        for k in range(3):
            group = store.create_group(f"trial{k + 1}")
            group.attrs["fs"] = RATE
            group["angle_deg"] = ANGLE + k
            group["torque_Nm"] = TORQUE
    found = inspect(tmp_path / "groups.h5")
    (trials,) = found.trials.values()
    assert trials.names == ("trial1", "trial2", "trial3")
    assert found.roles["angle"].rate_hz == pytest.approx(RATE)


@pytest.mark.parametrize(
    "below",
    ["END OF FILE\n", "\nMean,1,2,3,4,5,6\nSD,1,1,1,1,1,1\n", "Recorded by x; valid\n", "\n\n"],
)
def test_lines_below_the_numbers_are_left_out_aloud(file, below):
    path = file(made.timed(below=below))
    found = inspect(path)
    assert not found.faults
    said = [c.remark for c in found.channels]
    assert all("is not read" in text for text in said) == bool(below.strip())
    holds(mapped(path))


def test_a_last_row_that_was_cut_is_left_out_aloud(file):
    whole = made.timed()
    path = file(whole[: len(whole) - 30])
    assert all("cut short" in c.remark for c in inspect(path).channels)
    recording = mapped(path)
    assert len(recording.channels["angle"].values) == N - 1


def test_quoted_decimal_commas_are_read_aloud(file):
    rows = [
        ",".join(f'"{x:.7g}"'.replace(".", ",") for x in row)
        for row in np.column_stack([TIME, DATA])
    ]
    path = file(",".join(f'"{n}"' for n in ("Time (s)", *THEIRS)) + "\n" + "\n".join(rows) + "\n")
    assert all("decimal commas" in c.remark for c in inspect(path).channels)
    holds(mapped(path))


@pytest.mark.parametrize("index", [True, False])
def test_two_rows_of_names_are_one(file, index):
    first = ("signal", "angle", "torque", *["emg"] * 4)
    second = ("muscle", "", "", *MUSCLES)
    third = "time" + "," * 6 + "\n" if index else ""
    heads = (
        (",".join(first) + "\n" + ",".join(second) + "\n" + third)
        if index
        else ("time,angle,torque,emg,emg,emg,emg\n,,,TA,GL,SOL,GM\n")
    )
    body = made.timed("x").partition("\n")[2]
    path = file(heads + body)
    found = inspect(path)
    assert found.roles["emg_ta"].column == "emg TA"
    assert found.roles["emg_sol"].rate_hz == pytest.approx(RATE, rel=1e-3)
    settle = [
        (f'# unit = "{u}"', f'unit = "{v}"') for u, v in (("rad", "deg"), ("Nm", "Nm"), ("V", "mV"))
    ]
    holds(mapped(path, settle=settle))


@pytest.mark.parametrize(
    ("unit", "scale"), [("kp m", 9.80665), ("kpm", 9.80665), ("daNm", 10.0), ("kNm", 1e3)]
)
def test_units_of_other_times_are_known(file, unit, scale):
    data = DATA.copy()
    data[:, 1] /= scale
    path = file(made.timed(names=("Ankle angle (deg)", f"Torque [{unit}]", *THEIRS[2:]), data=data))
    assert inspect(path).roles["torque"].scale == pytest.approx(scale)
    holds(mapped(path))


def test_an_unknown_unit_is_quoted(file):
    path = file(made.timed(names=("Ankle angle (deg)", "Torque [Zlx]", *THEIRS[2:])))
    said = " ".join(inspect(path).advice)
    assert "the file says Zlx" in said
    assert "none" not in said.partition("the file says")[2][:10]
    assert "the file says 'Zlx'" in mapping_text(inspect(path), path.parent)
    micro = file(made.timed(names=(*THEIRS[:2], *(f"{m} (uVolt)" for m in MUSCLES))), "micro.csv")
    assert inspect(micro).roles["emg_ta"].known_unit == "uV"


@pytest.mark.parametrize("name", ["Force (N)", "Kraft [N]", "Load cell (N)", "Força (N)"])
def test_a_force_is_offered_times_its_lever_arm(file, name):
    path = file(made.timed(names=("Ankle angle (deg)", name, *THEIRS[2:])))
    found = inspect(path)
    assert [c.column for c in found.open["torque"]] == [name]
    assert not any("add its file" in line for line in found.advice)
    text = mapping_text(found, path.parent)
    assert "lever arm" in text


def test_what_is_in_the_file_is_not_called_a_missing_file(file):
    path = file(made.timed(names=("Kanal 1 (V)", "Kanal 2 (V)", *THEIRS[2:])))
    said = " ".join(inspect(path).advice)
    assert "'Kanal 1 (V)'" in said
    assert "add its file" not in said
    alone = file(made.timed(names=THEIRS[2:], data=EMG), "emg.csv")
    assert "angle and torque are missing" in " ".join(inspect(alone).advice)


def test_portuguese_names_are_found(file):
    names = ("Ângulo do tornozelo (graus)", "Torque (Nm)", *THEIRS[2:])
    holds(mapped(file(made.timed("Tempo (s)", names=names, between=";", decimal=","))))


@pytest.mark.parametrize("text", [made.labchart, made.acqknowledge, made.qualisys, made.anc])
def test_text_exports_of_programs_are_read_with_names_units_and_rates(file, text):
    path = file(text(), "export.txt")
    assert not is_mapping(open_source(path))
    found = inspect(path)
    assert {r: c.column for r, c in found.roles.items()} == {
        "angle": "Angle",
        "torque": "Torque",
        **{f"emg_{m.lower()}": m for m in MUSCLES},
    }
    settle = (
        []
        if found.roles["angle"].known_unit
        else [
            (f'# unit = "{u}"', f'unit = "{v}"')
            for u, v in (("rad", "deg"), ("Nm", "Nm"), ("V", "mV"))
        ]
    )
    holds(mapped(path, settle=settle))


def test_trigno_discover_is_read_under_its_sensors(file):
    found = inspect(file(made.discover()))
    assert found.roles["emg_sol"].column == "SOL (75922): EMG 1 (mV)"
    assert found.roles["emg_sol"].known_unit == "mV"
    assert found.roles["emg_sol"].rate_hz == pytest.approx(RATE, rel=1e-3)
    acc = next(c for c in found.channels if "ACC" in c.column)
    assert (acc.n, acc.unit) == (N // 10, "G")


@pytest.mark.parametrize("text", [made.opensignals, made.openbci])
def test_biosignals_boards_are_read_with_their_rate(file, text):
    found = inspect(file(text(), "x.txt"))
    channels = [c for c in found.channels if "Se" not in c.column and "Ind" not in c.column]
    assert len(channels) == 4
    assert all(c.rate_hz == pytest.approx(RATE) for c in channels)


def test_biodex_is_read_with_names_and_units(file):
    found = inspect(file(made.biodex(), "biodex.txt"))
    assert found.roles["torque"].known_unit == "Nm"
    assert [c.column for c in found.open["angle"]] == ["POSITION", "POS (ANAT)"]
    assert found.roles["torque"].rate_hz == pytest.approx(RATE / 5, rel=1e-3)


def test_rostopic_times_are_nanoseconds(file):
    found = inspect(file(made.rostopic()))
    assert found.roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)
    assert found.roles["emg_sol"].column == "field.emg_sol"
    assert "taken as ns" in found.roles["angle"].remark


def test_titles_of_spike2_say_the_roles(file):
    import scipy.io

    titles = ("Ankle", "Torque", "TA", "LG", "Soleus", "MG")
    units = ("deg", "N m", "mV", "mV", "mV", "mV")
    channels = {
        f"S01_Ch{k + 1}": {
            "title": title,
            "units": unit,
            "interval": 1 / RATE,
            "start": 0.0,
            "values": DATA[:, k],
        }
        for k, (title, unit) in enumerate(zip(titles, units, strict=True))
    }
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, channels)
    found = inspect(file(buffer.getvalue(), "s.mat"))
    roles = {role: c.column for role, c in found.roles.items()}
    assert roles["torque"] == "S01_Ch2"
    assert [roles[f"emg_{m}"] for m in ("ta", "gl", "sol", "gm")] == [
        f"S01_Ch{k}" for k in (3, 4, 5, 6)
    ]
    assert "angle" in {**found.roles, **found.open}


def tdms(starts, names=("Robot", "EMG")):
    """A TDMS file of two groups that began at different instants."""
    from nptdms import ChannelObject, TdmsWriter

    buffer = io.BytesIO()
    about = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0}
    signals = ((("Ankle Angle", "Ankle Torque"), DATA[:, :2]), (MUSCLES, EMG))
    with TdmsWriter(buffer) as writer:
        writer.write_segment(
            [
                ChannelObject(group, name, data[:, k].copy(), {**about, "wf_start_time": start})
                for group, start, (each, data) in zip(names, starts, signals, strict=True)
                for k, name in enumerate(each)
            ]
        )
    return buffer.getvalue()


@pytest.mark.parametrize("late", [0.5, -0.25, 0.0])
def test_streams_of_tdms_begin_when_they_say(file, late):
    began = np.datetime64("2024-05-04T10:11:12.000000")
    starts = (began, began + np.timedelta64(round(1e6 * late), "us"))
    found = inspect(file(tdms(starts), "x.tdms"))
    assert found.roles["emg_ta"].start_s == pytest.approx(max(late, 0.0), abs=1e-6)
    assert found.roles["angle"].start_s == pytest.approx(max(-late, 0.0), abs=1e-6)


def test_channels_of_lvm_begin_when_they_say(file):
    lines = [
        *("LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab"),
        *("Decimal_Separator\t.", "X_Columns\tNo", "***End_of_Header***\t", "\t", "Channels\t2"),
        "Samples\t64\t64",
        "Date\t2024/05/04\t2024/05/04",
        "Time\t10:11:12.0\t10:11:12.25",
        "Y_Unit_Label\tdeg\tNm",
        "X0\t0.0\t0.0",
        "Delta_X\t0.01\t0.01",
        "***End_of_Header***\t",
        "X_Value\tAnkle Angle\tAnkle Torque\tComment",
        *(f"\t{ANGLE[i]:.6g}\t{TORQUE[i]:.6g}\t" for i in range(64)),
    ]
    found = inspect(file("\r\n".join(lines) + "\r\n", "x.lvm"))
    assert found.roles["angle"].start_s == 0.0
    assert found.roles["torque"].start_s == pytest.approx(0.25)


@pytest.mark.parametrize("head", ["Interval=\t0.002 s\nName = x\n", "a = 1\nb=2\n", 'x = "y"\n\n'])
def test_a_text_with_keys_above_its_names_is_no_mapping(file, head):
    path = file(head + made.timed())
    assert not is_mapping(open_source(path))
    holds(mapped(path))


@pytest.mark.parametrize(
    "text", ["[channels.angle]\n", "name='x'\n[channels]\n", "channels.angle.column = 'a'\n"]
)
def test_a_mapping_is_known_by_its_channels(file, text):
    assert is_mapping(open_source(file(text, "m.txt")))
    with pytest.raises(InputError, match="no TOML mapping"):
        open_mapping(file("a,b\n1,2\n", "n.csv"))


def test_recordings_in_subfolders_are_found(file, tmp_path):
    file("participant_id\tage\nsub-01\t30\n", "bids/participants.tsv")
    file('{"Name": "x"}', "bids/dataset_description.json")
    inner = file(made.timed("time_s", names=OURS), "bids/sub-01/emg/sub-01_emg.csv")
    file("onset\tduration\n0\t1\n", "bids/sub-01/emg/sub-01_events.tsv")
    assert data_files_below(tmp_path / "bids") == [inner]
    other = file(made.timed("time_s", names=OURS), "notes/leg/a.csv")
    file("we met\non Monday\n", "notes/readme.txt")
    assert data_files_below(tmp_path / "notes") == [other]
    beside = file(made.timed("time_s", names=OURS), "flat/b.csv")
    file(made.timed("time_s", names=OURS), "flat/old/c.csv")
    assert data_files_below(tmp_path / "flat") == [beside]


def test_one_files_trouble_never_blocks_anothers(file):
    good = file(made.timed("Czas [s]"), "good.csv")
    bad = file(b"\x00\x01" * 50, "bad.csv")
    text = file("Interval=\t1 s\nnothing here\n", "bad.txt")
    found = inspect_trials([bad, good, text])
    assert found.roles["angle"].column == THEIRS[0]
    assert sum("set aside" in line for line in found.advice) == 2


def test_what_maps_nothing_is_said_in_one_sentence(file):
    path = file(
        "time_s,depth,salinity\n" + "".join(f"{i / 10},{i % 7},{i % 5}\n" for i in range(50))
    )
    found = inspect(path)
    assert not found.roles
    assert not found.open
    said = nothing_mapped(found)
    assert "'depth', 'salinity'" in said
    assert "\n" not in said
    noraxon = file("Noraxon MR3\nfoo\nbar\n", "n.txt")
    with pytest.raises(InputError, match="likely Noraxon MR3"):
        inspect(noraxon)


def test_clock_ppm_puts_a_fast_clock_right(file):
    emg = made.timed("time_s", TIME * 1.002, names=OURS[2:], data=EMG)
    file(emg, "emg.csv")
    file(made.timed("time_s", names=OURS[:2], data=DATA[:, :2]), "robot.csv")
    channels = "".join(
        f'[channels.{role}]\nfile = "{source}.csv"\ncolumn = "{column}"\n{more}'
        for role, source, column, more in (
            ("angle", "robot", "angle_deg", ""),
            ("torque", "robot", "torque_Nm", ""),
            ("emg_sol", "emg", "emg_sol_mV", "clock_ppm = 2000\n"),
        )
    )
    toml = file("fixed = { g1 = 0.0, g2 = 0.0, g4 = 0.0 }\n" + channels, "map.toml")
    sol = read(toml).channels["emg_sol"]
    np.testing.assert_allclose(sol.time, TIME, atol=2e-6)
    assert "clock 2000 ppm fast" in sol.source
    toml.write_text(toml.read_text().replace("clock_ppm = 2000", "clock_ppm = 2000\nstart_s = 0.5"))
    late = read(toml).channels["emg_sol"]
    np.testing.assert_allclose(late.time, 0.5 + TIME, atol=2e-6)
    toml.write_text(toml.read_text().replace("2000", "2e6"))
    with pytest.raises(InputError, match="clock_ppm is 2e"):
        read(toml)


def test_within_a_description_trials_are_named(file):
    path = file(made.trials())
    toml = file(mapping_text(inspect(path), path.parent), "map.toml")
    within = Description.of(open_source(toml)).within()
    assert list(within) == ["1", "2", "3"]


def test_one_mapping_of_a_folder_is_offered_for_files_with_its_columns(file, tmp_path):
    first = file(made.timed("Czas [s]"), "a.csv")
    file(mapping_text(inspect(first), tmp_path), "a.toml")
    others = [file(made.timed("Czas [s]", data=DATA + k), f"{k}.csv") for k in (1, 2)]
    file(made.timed("time_s", names=OURS), "other.csv")
    found = inspect_trials([first, *others])
    (line,) = (line for line in found.typical.advice if "one mapping does" in line)
    assert "'1.csv', '2.csv' have the same columns" in line
    assert "other.csv" not in line
    holds(read(first, mapping=tmp_path / "a.toml"))
    np.testing.assert_allclose(
        np.degrees(read(others[1], mapping=tmp_path / "a.toml").channels["angle"].values),
        ANGLE + 2,
        atol=1e-3,
    )


@pytest.mark.parametrize("style", ["importdata", "simulink"])
def test_structures_of_matlab_are_read_with_names_and_times(file, style):
    import scipy.io

    if style == "importdata":
        heads = np.array(["Time (s)", *THEIRS], dtype=object)
        whole = np.column_stack([TIME, DATA])
        structure = {"data": whole, "colheaders": heads, "textdata": heads}
    else:
        signals = np.array(
            [(DATA[:, k : k + 1], THEIRS[k], 1.0) for k in range(len(THEIRS))],
            dtype=[("values", object), ("label", object), ("dimensions", object)],
        )
        structure = {"time": TIME[:, None], "signals": signals, "blockName": "m/To Workspace"}
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, {"A": structure})
    path = file(buffer.getvalue(), "a.mat")
    found = inspect(path)
    assert found.roles["angle"].column == f"A.{THEIRS[0]}"
    assert found.roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)
    holds(mapped(path))


def test_hdf5_of_h5py_is_not_called_matlab_and_nwb_is_scaled(file, tmp_path):
    import h5py

    path = tmp_path / "x.nwb"
    with h5py.File(path, "w") as store:
        series = store.create_group("acquisition/emg_ta")
        series["data"] = np.round(EMG[:, 0] * 1e4).astype("i2")
        series["data"].attrs["conversion"] = 1e-7
        series["data"].attrs["unit"] = "volts"
        series["starting_time"] = 0.25
        series["starting_time"].attrs["rate"] = RATE
        series["starting_time"].attrs["unit"] = "seconds"
    found = inspect(path)
    assert set(found.formats.values()) == {"HDF5"}
    (channel,) = found.channels
    assert (channel.unit, channel.start_s) == ("volts", 0.25)
    assert channel.rate_hz == pytest.approx(RATE)
    assert channel.high == pytest.approx(1e-3 * EMG[:, 0].max(), rel=1e-3)
    assert found.roles["emg_ta"].known_unit == "V"


def test_a_unit_of_all_columns_in_a_line_above_is_read(file):
    head = "BTS ASCII format\n\nTracks:\t4\nFrequency:\t500 Hz\nMeasure unit:\tV\n\n"
    body = made.timed("Time", names=MUSCLES, data=EMG / 1e3, between="\t")
    found = inspect(file(head + body, "x.emt"))
    assert found.roles["emg_sol"].known_unit == "V"
    assert found.roles["emg_sol"].rate_hz == pytest.approx(RATE, rel=1e-3)


def test_a_long_preface_of_keys_and_numbers_is_no_heading(file):
    lines = [f"Key {k}:\t{k}" for k in range(50)]
    body = made.biodex().splitlines()[4:]
    found = inspect(file("\n".join([*lines, *body]) + "\n", "b.txt"))
    assert found.roles["torque"].known_unit == "Nm"
    assert found.roles["torque"].rate_hz == pytest.approx(RATE / 5, rel=1e-3)
