"""A file that was cut short is refused, or says so: one rule for all readers."""

import random

import pytest
from reader_seeds import SEEDS

from marks import slow
from surae.base.errors import InputError
from surae.recording.formats import open_table
from surae.recording.source import open_source
from surae.recording.table import load_each

#: Texts that announce no number of samples: what is lost shows where their last row is not whole.
#: FILELB's cases follow each other, and none says how many there are.
UNANNOUNCED = {"delimited", "layouts", "text-uncounted", "vicon", "filelb"}


def looked_at(path):
    """Samples of every column, and all that is said; None where it is refused."""
    try:
        table = open_table(open_source(path), timed=False)
        columns = load_each(table, table.names)
    except InputError:
        return None
    if any(isinstance(column, InputError) for column in columns.values()):
        return None
    said = [*table.remarks.values(), *(column.remark for column in columns.values())]
    return {name: len(column.values) for name, column in columns.items()}, "; ".join(said)


#: Trigno Discover states seconds, and its sensors end some samples apart: so many tell nothing.
ALLOWED = {"discover": 2}
#: Parts that are left: three always, and twenty anywhere behind a heading.
PARTS = [0.55, 0.8, 0.97]
ANYWHERE = [slow(part / 1e4) for part in random.Random(71).choices(range(4000, 9990), k=20)]


@pytest.mark.parametrize("part", [*PARTS, *ANYWHERE])
@pytest.mark.parametrize("reader", SEEDS)
def test_every_readers_file_that_is_cut_is_refused_or_says_so(tmp_path, reader, part):
    path = tmp_path / "file"
    for make in SEEDS[reader]:
        whole = make()
        path.write_bytes(whole)
        before = looked_at(path)
        assert before is not None
        assert "cut short" not in before[1]
        path.write_bytes(whole[: round(part * len(whole))])
        if (after := looked_at(path)) is None:
            continue
        if not after[0].keys() & before[0].keys():  # cut in its heading: of it nothing is known
            continue
        few = ALLOWED.get(reader, 0)
        lost = any(after[0].get(name, 0) < n - few for name, n in before[0].items())
        *_, above, last = whole[: round(part * len(whole))].split(b"\n")
        cells, full = ([row.count(b) for b in (b",", b"\t", b";")] for row in (last, above))
        whole_row = cells == full or not last.strip()
        if lost and not (reader in UNANNOUNCED and (whole_row or reader == "filelb")):
            assert "cut short" in after[1], (reader, part, after)
