"""Every page: readable for all, at home on this computer, on a small screen and in the dark."""

import re
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from surae.studies.study import parse_study

from .conftest import Desk, expect

AXE = files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8")
#: What is looked at: everything in the light; in the dark, where only colours differ, these.
LEVELS = {
    "light": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"],
    "dark": {"type": "rule", "values": ["color-contrast", "link-in-text-block"]},
}
#: A telephone, a tablet and a large screen.
SCREENS = ((390, 844), (820, 1180), (1440, 900))
#: An A4 within its margins, at 96 dots per inch.
PAPER = {"width": 718, "height": 1047}
#: What a keyboard must reach: what can be seen and used, but for a group's other choices.
REACHED = """() => {
  const all = "a[href], button, input, select, textarea, summary, [tabindex='0']";
  const able = (one) => one.checkVisibility() && !one.disabled && one.tabIndex >= 0;
  return [...document.querySelectorAll(all)]
    .filter((one) => able(one) && one.type !== "radio")
    .map((one, i) => (one.dataset.reach = i)).length;
}"""
#: Which of them has the focus, and whether that is seen.
FOCUSED = """() => {
  const one = document.activeElement;
  const look = getComputedStyle(one);
  const seen = look.outlineStyle !== "none" || look.boxShadow !== "none";
  return [one.dataset.reach ?? null, seen];
}"""
#: What says that a page has been filled.
FILLED = {
    "/": "#fits tbody tr",
    "/import": "#drop",
    "/recordings/{recording}": "#plots canvas",
    "/fit": "#parameters tbody tr",
    "/fits/{fit}": ".report .uplot canvas",
    "/live": "code",
    "/analyse": "#trials tbody tr",
    "/sessions/{session}": ".report .card",
    "/cohort": "#table tbody tr",
    "/plan": "#prediction tbody tr",
    "/studies": "#list tbody tr",
    "/nowhere": ".alert",
}


def filled(desk: Desk, done: dict[str, str], path: str) -> Any:
    """A page, filled, with all that it has lying open."""
    page = desk.go(path.format(**done))
    page.locator(FILLED[path]).first.wait_for(state="attached")
    page.evaluate("document.querySelectorAll('details').forEach(one => (one.open = true))")
    return page


def fits(page: Any, size: dict[str, int]) -> None:
    """A page is no wider than what shows it."""
    page.set_viewport_size(size)
    page.wait_for_function(
        "width => document.documentElement.scrollWidth <= width", arg=size["width"]
    )


def shut_out(page: Any, name: str, scheme: str) -> list[str]:
    """What keeps somebody from using a page, as axe finds it."""
    page.emulate_media(color_scheme=scheme)
    expect(page.locator("html")).to_have_attribute("data-theme", scheme)
    if not page.evaluate("'axe' in window"):
        page.evaluate(AXE)
    told = page.evaluate(
        """levels => axe.run({ runOnly: levels, resultTypes: ['violations'], preload: false })""",
        LEVELS[scheme],
    )
    return [
        f"{name}: {violation['id']} ({violation['help']}) at "
        f"{[node['target'] for node in violation['nodes']][:3]}"
        for violation in told["violations"]
    ]


#: What the server says of recordings where there are none.
NONE: dict[str, list[object]] = {"recordings": []}


@pytest.mark.parametrize(
    "screens", [SCREENS[:1], pytest.param(SCREENS[1:], marks=pytest.mark.slow)]
)
def test_pages_fit_the_screen_and_ask_nobody_else(
    desk: Desk, done: dict[str, str], screens: tuple[tuple[int, int], ...]
) -> None:
    desk.research(True)
    for path in FILLED:
        page = filled(desk, done, path)
        for width, height in screens:
            fits(page, {"width": width, "height": height})
        assert page.locator("#main > .alert:visible").count() == (path == "/nowhere"), path
    desk.research(False)


@pytest.mark.slow
def test_what_shuts_somebody_out_is_found(desk: Desk) -> None:
    page = desk.go("/live")
    page.evaluate("document.body.append(document.createElement('img'))")  # without a text
    assert any("image-alt" in told for told in shut_out(page, "live", "light"))


@pytest.mark.slow  # axe looks at all of every page
@pytest.mark.parametrize("path", FILLED)
def test_a_page_shuts_nobody_out(desk: Desk, done: dict[str, str], path: str) -> None:
    """On a telephone and a large screen, in the dark, by keyboard alone, and on paper."""
    desk.research(True)
    page = filled(desk, done, path)
    told = []
    for width, height in (SCREENS[0], SCREENS[-1]):
        page.set_viewport_size({"width": width, "height": height})
        told += [shut_out(page, f"{path} at {width}", scheme) for scheme in LEVELS]
    assert not any(told), told
    reached, wanted, unseen = set(), page.evaluate(REACHED), []
    page.evaluate("document.activeElement.blur()")
    for _ in range(2 * wanted + 20):
        page.keyboard.press("Tab")
        number, seen = page.evaluate(FOCUSED)
        reached.add(number)
        unseen += [number] * (not seen and number is not None)
        if len(reached - {None}) == wanted:
            break
    assert len(reached - {None}) == wanted
    assert unseen == []
    page.emulate_media(media="print", color_scheme="light")
    fits(page, PAPER)
    desk.research(False)


def test_research_is_there_for_whoever_switches_it_on(desk: Desk, done: dict[str, str]) -> None:
    page = desk.go(f"/fits/{done['fit']}")
    hidden = page.get_by_role("link", name="Studies"), page.locator("#profiles")
    for each in hidden:
        expect(each).to_be_hidden()
    page.get_by_role("checkbox", name="Research").check()
    for each in hidden:
        expect(each).to_be_visible()
    page.reload()
    expect(hidden[1]).to_be_visible()
    page.get_by_role("checkbox", name="Research").uncheck()
    expect(hidden[1]).to_be_hidden()


@pytest.mark.slow  # in the fast suite test_web_jobs.py asks for it without a browser
def test_other_trials_are_predicted(desk: Desk, done: dict[str, str]) -> None:
    desk.research(True)
    page = desk.go(f"/fits/{done['fit']}")
    page.get_by_text("Predict other trials").click()
    page.locator("#validate-list").get_by_role("checkbox").first.check()
    page.get_by_role("button", name="Predict", exact=True).click()
    page.locator("#predictions figure img").first.wait_for()
    desk.research(False)


def test_a_study_is_made_without_toml(desk: Desk) -> None:
    page = desk.go("/studies")
    page.get_by_label("Amplitude of the chirp [rad]").fill("0, 0.15")
    page.get_by_label("Virtual legs").fill("3")
    page.get_by_role("checkbox", name="passive", exact=True).check()
    expect(page.locator("#count")).to_have_text("12 fits: every value with every other.")
    study = parse_study(page.locator("#toml").input_value())
    assert study.size == 12
    assert study.factors["chirp_amplitude"] == (0.0, 0.15)
    assert study.factors["task"] == ("part-passive", "passive")
    page.get_by_label("Amplitude of the chirp [rad]").fill("0, much")
    expect(page.locator("#start")).to_be_disabled()


@pytest.mark.slow  # in the fast suite test_web_descriptions.py does it without a browser
def test_one_click_mends_what_the_check_is_sure_of(desk: Desk, csv: Path, tmp_path: Path) -> None:
    lines = csv.read_text().splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
    column = lines[head].split(",").index("torque_Nm")
    rows = [line.split(",") for line in lines[head + 1 :]]
    for row in rows:
        row[column] = str(-float(row[column]))
    turned = tmp_path / "turned.csv"
    turned.write_text("\n".join([*lines[: head + 1], *(",".join(row) for row in rows)]) + "\n")
    page = desk.go(f"/recordings/{desk.add(turned)}")
    page.get_by_role("button", name="Turn the torque").click()
    page.get_by_text("Turn the torque: done. Undo takes it back.").wait_for()
    expect(page.get_by_role("button", name="Turn the torque")).to_have_count(0)
    page.locator("#undo").click()
    page.get_by_role("button", name="Turn the torque").wait_for()


@pytest.mark.slow
def test_a_legs_report_comes_in_the_language_that_is_chosen(
    desk: Desk, done: dict[str, str]
) -> None:
    page = desk.go(f"/sessions/{done['session']}")
    page.get_by_label("Language").select_option("nl")
    page.locator("html[lang=nl]").wait_for()
    page.locator("#undo[aria-label]").wait_for()
    with page.expect_download() as file:
        page.locator("#report-html").click()
    text = Path(file.value.path()).read_text(encoding="utf-8")
    assert "Hoe stijf is het?" in text


def test_a_leg_is_read_on_paper_and_on_a_telephone(desk: Desk, done: dict[str, str]) -> None:
    page = desk.page
    page.set_viewport_size({"width": 390, "height": 844})
    desk.go(f"/sessions/{done['session']}")
    for medium in ("screen", "print"):
        page.emulate_media(media=medium)
        for part in ("h2", "img"):
            shown = page.locator(f".report .card {part}").first
            expect(shown).to_be_visible()
            assert len(colours(shown.screenshot())) > 10, (medium, part)


def colours(png: bytes) -> set[tuple[int, ...]]:
    """The colours that a picture has: one or two where it is blank."""
    picture = Image.open(BytesIO(png)).convert("RGB").getcolors(1 << 20)
    return {colour for _, colour in picture or []}


@pytest.mark.slow  # in the fast suite the fit's page shows the same plots
def test_a_kept_reports_plots_are_zoomed_and_read_without_any_server(
    browser: Any, desk: Desk, done: dict[str, str], tmp_path: Path
) -> None:
    page = desk.go(f"/fits/{done['fit']}")
    with page.expect_download() as file:
        page.get_by_role("button", name="Report (HTML)").click()
    file.value.save_as(tmp_path / "report.html")
    context = browser.new_context(offline=True, viewport={"width": 1280, "height": 800})
    asked: list[str] = []
    context.on("request", lambda request: asked.append(request.url))
    kept = context.new_page()
    kept.goto((tmp_path / "report.html").as_uri())
    kept.locator("summary", has_text="Details").first.click()
    plot = kept.locator(".uplot").first
    plot.scroll_into_view_if_needed()
    box = plot.locator(".u-over").bounding_box()
    assert box is not None

    def at(share: float) -> float:
        """The time that the plot tells where the cursor is."""
        kept.mouse.move(box["x"] + share * box["width"], box["y"] + 0.5 * box["height"])
        values = plot.locator(".u-value")
        expect(values.nth(1)).to_have_text(re.compile(r"^−?[0-9.]+$"))  # the measured torque
        return float(values.first.inner_text().replace("−", "-"))

    quarter, half = at(0.25), at(0.5)
    assert quarter < half
    at(0.25)
    kept.mouse.down()
    at(0.75)
    kept.mouse.up()
    assert at(0.01) == pytest.approx(quarter, abs=0.1 * half)
    kept.mouse.dblclick(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert at(0.25) == pytest.approx(quarter, abs=0.1)
    assert all(url.startswith(("file:", "data:")) for url in asked)
    context.close()


@pytest.mark.slow
def test_the_report_is_downloaded_for_paper(desk: Desk, done: dict[str, str]) -> None:
    page = desk.go(f"/fits/{done['fit']}")
    with page.expect_download() as file:
        page.get_by_role("button", name="Report (PDF)").click()
    assert file.value.suggested_filename == "seeded-fit.pdf"
    content = Path(file.value.path()).read_bytes()
    assert content.startswith(b"%PDF")
    assert len(content) > 20_000  # figures and tables
    page.get_by_role("button", name="Report (PDF)").wait_for()
    expect(page.locator("#error")).to_be_hidden()


@pytest.mark.slow  # in the fast suite test_web_demo.py asks for it
def test_the_virtual_subject_is_a_button_away(desk: Desk) -> None:
    page = desk.page
    page.route("**/api/recordings", lambda route: route.fulfill(json=NONE))
    desk.go("/")
    page.get_by_role("button", name="Try it with the virtual subject").click()
    page.wait_for_url("**/recordings/*")
    page.get_by_role("heading", name="virtual subject, trial 1", level=1).wait_for()
    page.locator("#plots canvas").first.wait_for()


def test_drives_come_into_the_table_and_go(desk: Desk, done: dict[str, str]) -> None:
    change = {"recordings": [done["recording"]], "model": "muscle"}
    desk.api("PATCH", "/api/draft", {"change": change, "label": "choose"})
    page = desk.go("/fit")
    page.get_by_label("Slider of m", exact=True).wait_for()
    assert page.get_by_label("Slider of emd", exact=True).count() == 0
    page.get_by_role("checkbox", name="Estimate an EMG delay").check()
    slider = page.get_by_label("Slider of emd", exact=True)
    slider.wait_for()
    with page.expect_response("**/api/live") as answer:
        slider.press("PageUp")
    assert answer.value.status == 200
    page.get_by_role("button", name="Undo: slide emd").wait_for()

    page.get_by_label("emd is free", exact=True).click()  # held, but still there
    page.get_by_role("button", name="Undo: fix emd").wait_for()
    slider.wait_for()
    page.get_by_role("checkbox", name="Estimate a stretch reflex").check()
    for name in ("reflex_tri", "reflex_tib", "reflex_delay"):
        expect(page.get_by_label(f"{name} is free", exact=True)).to_be_checked()
    page.get_by_role("checkbox", name="Estimate an EMG delay").uncheck()
    slider.wait_for(state="detached")
    draft = desk.api("GET", "/api/draft")["draft"]
    assert set(draft["parameters"]) == {"reflex_tri", "reflex_tib", "reflex_delay"}
    assert draft["sliders"] == {}
    expect(page.locator("#start")).to_be_enabled()


def test_plots_are_zoomed_from_the_keyboard(desk: Desk, done: dict[str, str]) -> None:
    page = desk.go(f"/recordings/{done['recording']}")
    page.locator("#plots canvas").first.wait_for()
    with page.expect_request("**/window?*start=*") as asked:
        page.get_by_role("group", name="Signals of seeded").press("+")
    assert "end=" in asked.value.url


def test_the_keyboard_reaches_the_content_first(desk: Desk) -> None:
    page = desk.go("/cohort")
    page.keyboard.press("Tab")
    expect(page.get_by_role("link", name="Skip to the content", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#main")).to_be_focused()


def test_the_theme_is_the_systems(desk: Desk) -> None:
    page = desk.go("/studies")
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        expect(page.locator("html")).to_have_attribute("data-theme", scheme)


def test_what_was_deleted_comes_back(desk: Desk) -> None:
    page = desk.go("/")
    page.get_by_role("button", name="Add a subject").click()
    page.get_by_label("Code, for example S01").fill("Z09")
    page.get_by_role("button", name="Save").click()
    page.get_by_role("button", name="Delete Z09").click()
    page.get_by_role("button", name="Delete Z09").wait_for(state="detached")
    page.get_by_role("button", name="Undo").first.click()
    page.get_by_role("button", name="Delete Z09").wait_for()
