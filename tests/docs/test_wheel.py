"""The wheel holds all of the package and nothing else."""

import zipfile
from pathlib import Path

import pytest
from hatchling.build import build_wheel

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def names(tmp_path_factory) -> set[str]:
    """What a wheel of this tree holds."""
    folder = tmp_path_factory.mktemp("wheel")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        name = build_wheel(str(folder))
    with zipfile.ZipFile(folder / name) as wheel:
        return set(wheel.namelist())


def test_it_holds_every_file_of_the_package(names):
    source = ROOT / "src"
    files = {
        path.relative_to(source).as_posix()
        for package in ("surae", "surae_thesis")
        for path in (source / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    held = {name for name in names if not name.split("/")[0].endswith(".dist-info")}
    assert held == files
    for needed in ("py.typed", "report/templates/page.html.j2", "web/static/icon.svg"):
        assert f"surae/{needed}" in held


def test_it_holds_the_licences(names):
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in names)
    vendored = {name.rsplit("/", 1)[0] for name in names if "/static/vendor/" in name}
    folders = {folder for folder in vendored if not folder.endswith("/vendor")}
    assert folders
    assert [folder for folder in folders if f"{folder}/LICENSE" not in names] == []
