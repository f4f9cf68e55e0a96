"""The wheels hold all of their packages and nothing else."""

import zipfile
from pathlib import Path

import pytest
from hatchling.build import build_wheel

ROOT = Path(__file__).parents[2]


def held(project: Path, folder: Path) -> set[str]:
    """What a wheel of a project holds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(project)
        name = build_wheel(str(folder))
    with zipfile.ZipFile(folder / name) as wheel:
        return set(wheel.namelist())


DISTRIBUTIONS = ("surae", *sorted(path.parent.name for path in ROOT.glob("[a-z]*/pyproject.toml")))


@pytest.fixture(scope="module", params=DISTRIBUTIONS)
def wheel(request, tmp_path_factory) -> tuple[Path, set[str]]:
    """The folder of a distribution's source, and what its wheel holds."""
    project = ROOT if request.param == "surae" else ROOT / request.param
    return project / "src", held(project, tmp_path_factory.mktemp("wheel"))


def test_it_holds_every_file_of_its_packages(wheel):
    source, names = wheel
    files = {
        path.relative_to(source).as_posix()
        for path in source.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {name for name in names if not name.split("/")[0].endswith(".dist-info")} == files
    needed = {
        ROOT / "src": (
            "surae/py.typed",
            "surae/report/templates/page.html.j2",
            "surae/recording/programs/c3d.py",
        ),
        ROOT / "thesis" / "src": ("surae_thesis/claims/tendons.toml",),
        ROOT / "workbench" / "src": ("surae_workbench/web/static/icon.svg",),
        ROOT / "legs" / "src": ("ankle_legs/main.py",),
    }
    assert set(needed[source]) <= names


def test_it_holds_the_licences(wheel):
    source, names = wheel
    vendored = {name.rsplit("/", 1)[0] for name in names if "/static/vendor/" in name}
    folders = {folder for folder in vendored if not folder.endswith("/vendor")}
    assert bool(folders) == (source.parent == ROOT)
    assert [folder for folder in folders if f"{folder}/LICENSE" not in names] == []
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in names)
