"""What is seen of a fit before anybody scrolls, and on the first sheet of paper."""

from pathlib import Path
from typing import Any

import pytest

import surae

#: A laptop's window, and what an A4 sheet holds within the page's margins, at 96 dots an inch.
WINDOW = {"width": 1366, "height": 768}
SHEET = {"width": int(180 / 25.4 * 96), "height": int(263 / 25.4 * 96)}
TELEPHONE = {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def page(browser: Any, csv: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The report of a fit, open in a window that asks nothing of a server."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    surae.fit(csv, model="muscle", starts=1).report(path)
    context = browser.new_context(viewport=WINDOW, offline=True)
    opened = context.new_page()
    opened.goto(path.as_uri())
    yield opened
    context.close()


def ends(page: Any) -> dict[str, float]:
    """Where the lowest of each kind ends [pixels]."""
    kinds = {"picture": ".first img", "table": ".first table", "grade": "main > .adequacy"}
    return {
        kind: max(each.bounding_box()["y"] + each.bounding_box()["height"] for each in shown)
        for kind, where in kinds.items()
        if (shown := page.locator(where).all())
    }


def test_picture_and_table_are_seen_without_scrolling(page: Any) -> None:
    page.set_viewport_size(WINDOW)
    places = ends(page)
    assert set(places) == {"picture", "table", "grade"}
    assert max(places.values()) <= WINDOW["height"]
    assert page.locator(".first > figure").count() == 2
    for image in page.locator(".first img").all():
        assert image.bounding_box()["width"] > 300
    assert page.locator(".first tbody tr").count() >= 5


def test_the_first_sheet_of_paper_holds_them(page: Any) -> None:
    page.emulate_media(media="print")
    page.set_viewport_size(SHEET)
    assert max(ends(page).values()) <= SHEET["height"]
    page.emulate_media(media="screen")


def test_on_a_telephone_nothing_goes_off_the_side(page: Any) -> None:
    page.set_viewport_size(TELEPHONE)
    assert page.evaluate("document.documentElement.scrollWidth") <= TELEPHONE["width"]
    for image in page.locator(".first img").all():
        box = image.bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= TELEPHONE["width"]
