"""A browser visits every page of a project whose every name is an attack."""

from pathlib import Path
from typing import Any

import surae
from surae.recording import write_hdf5
from web.hostile import hostile_project

from .conftest import Desk, Server

PAGES = (
    "/",
    "/import",
    "/recordings/{recording}",
    "/fit",
    "/analyse",
    "/sessions/{session}",
    "/cohort",
    "/plan",
    "/studies",
    "/live",
)


def test_nothing_runs_and_nothing_leaves(browser: Any, tmp_path: Path) -> None:
    write_hdf5(tmp_path / "trial.h5", surae.example().crop(0.0, 3.0))
    ids = hostile_project(tmp_path / "project", tmp_path / "trial.h5")
    server = Server(tmp_path / "project")
    try:
        desk = Desk(browser, server)
        for path in PAGES:
            page = desk.go(path.format(**ids))
            page.wait_for_timeout(1500)
            assert page.url.startswith(server.address.rstrip("/")), path
            assert page.title() != "taken", path
            assert page.locator("meta[http-equiv=refresh], base").count() == 0, path
            assert page.locator("img[src*='attack.invalid']").count() == 0, path
        assert [each for each in desk.outside if "attack" in each] == []
    finally:
        server.stop()
