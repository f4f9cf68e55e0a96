"""`surae impedance` from the shell."""

import json


def test_a_measured_ankle_gives_table_file_and_page(run, shared, tmp_path) -> None:
    record = shared / "perturbed" / "plantarflexing.csv"
    done = run(
        "impedance", record, "--output", tmp_path / "i.json", "--report", tmp_path / "i.html"
    )
    assert done.code == 0
    assert done.out.startswith("Reflex: present")
    plain = json.loads((tmp_path / "i.json").read_text("utf-8"))
    assert plain["reflex"]["direction"] == "dorsiflexion"
    assert "How much is nerve?" in (tmp_path / "i.html").read_text("utf-8")
