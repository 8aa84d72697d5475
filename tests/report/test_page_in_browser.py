"""The page of a diagnosis in a real browser: drawn, silent, off the network, readable on a desk, on a telephone and on paper."""

from __future__ import annotations

import time
from functools import partial
from pathlib import Path

import pytest
from diagnosed import LENGTH, curves, document, swing

import harness
from harness.report.diagnosis.page import diagnosis_html

PENDULUM = Path(__file__).parents[2] / "models" / "urdf" / "rigid_pendulum.urdf"
SLOWEST = 120.0  # s: a busy machine takes a minute to draw a page
PLOTS = 7  # two recordings: motion and residual of each; missing force over velocity and position; spectrum


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "report.html"
    file.write_text(diagnosis_html(document(), curves(), harness.load(PENDULUM)), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def opened(open_page, address):
    """Open the page: (page, what it said on its console, what it asked for)."""
    return partial(open_page, address)


def eventually(page, holds) -> None:
    """Wait until something holds, as long as for a page: it draws when the browser finds the time."""
    end = time.monotonic() + SLOWEST
    while not holds() and time.monotonic() < end:
        page.wait_for_timeout(100)
    assert holds()


@pytest.mark.parametrize("width", [390, 1280])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_plot_is_drawn_in_silence_and_nothing_is_fetched(opened, address, width, scheme):
    page, said, asked = opened(width, scheme)
    page.wait_for_function("document.querySelectorAll('.uplot canvas').length")
    assert page.locator(".uplot canvas").count() == PLOTS
    # The picture for paper takes no room on the screen.
    assert page.locator(".still:visible").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert said == [] and asked == [address]
    # Ink is drawn: some pixel of every canvas is not transparent, and is dark on light or light on dark.
    inked = page.evaluate(
        """Array.from(document.querySelectorAll('.uplot canvas'), c => {
             const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
             let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (c.width * c.height); })"""
    )
    assert min(inked) > 0.005
    # Who hears the page is told what every picture shows, and what every header heads.
    assert page.locator("th:not([scope])").count() == 0
    unnamed = page.evaluate(
        """Array.from(document.querySelectorAll('canvas, svg, img'))
             .filter(e => !e.getAttribute('role') || !(e.getAttribute('aria-label') || e.querySelector('title')))
             .map(e => e.outerHTML.slice(0, 80))"""
    )
    assert unnamed == []


def test_the_value_under_the_pointer_is_the_measured_one(opened):
    page, _, _ = opened()
    over = page.locator(".uplot .u-over").first
    box = over.bounding_box()
    over.hover(position={"x": box["width"] / 3.0, "y": box["height"] / 2.0})
    values = page.locator(".uplot").first.locator(".u-value").all_inner_texts()
    labels = page.locator(".uplot").first.locator(".u-label").all_inner_texts()
    told = dict(zip(labels, map(float, values), strict=True))
    # Within a pixel of the third of the axis, which reaches from 0 to 8 s.
    assert abs(told["time [s]"] - LENGTH / 3.0) < 0.05
    assert told["measured"] == pytest.approx(swing(told["time [s]"]), abs=2e-4)
    assert told["nominal"] == pytest.approx(0.9 * swing(told["time [s]"]), abs=2e-4)


def test_dragging_zooms_all_that_shows_the_same_recording(opened):
    page, said, _ = opened()
    over = page.locator(".uplot .u-over").first
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 50, steps=5)
    page.mouse.up()

    def at_the_right_end(plot: int) -> float:
        area = page.locator(".uplot .u-over").nth(plot)
        size = area.bounding_box()
        area.hover(position={"x": size["width"] - 1.0, "y": size["height"] / 2.0})
        return float(page.locator(".uplot").nth(plot).locator(".u-value").first.inner_text())

    # Dragged from 2 s to 4 s of the recording held out; its residual (third plot) follows, the other recording does not.
    eventually(page, lambda: at_the_right_end(0) == pytest.approx(4.0, abs=0.05))
    assert at_the_right_end(2) == pytest.approx(4.0, abs=0.05)
    assert at_the_right_end(1) == pytest.approx(8.0, abs=0.05)
    page.get_by_role("button", name="the whole").first.click()
    eventually(page, lambda: at_the_right_end(2) == pytest.approx(8.0, abs=0.05))
    assert said == []


def test_tables_are_sorted_and_filtered(opened):
    page, said, _ = opened()
    rows = page.locator("#ranking tbody tr")

    def column() -> list[float]:
        return [float(text) for text in page.locator("#ranking tbody tr td:nth-child(2)").all_inner_texts()]

    given = column()
    assert len(set(given)) == 11 and given != sorted(given)
    page.locator("#ranking th", has_text="ΔBIC").click()
    eventually(page, lambda: column() == sorted(given, reverse=True))
    page.locator("#ranking th", has_text="ΔBIC").click()
    eventually(page, lambda: column() == sorted(given))
    page.locator("#ranking input").fill("effect 7@")
    assert [row.is_visible() for row in rows.all()].count(True) == 1
    assert page.locator("#ranking").get_by_role("status").inner_text() == "1 of 11 rows"
    assert said == []


def test_paper_and_pages_without_scripts_have_the_pictures(opened):
    page, _, _ = opened()
    page.emulate_media(media="print")
    assert page.locator(".still:visible").count() == PLOTS and page.locator(".uplot:visible").count() == 0
    silent, _, _ = opened(java_script_enabled=False)
    assert silent.locator(".still:visible").count() == PLOTS


def test_on_paper_no_table_is_cut(opened):
    """A sheet of Letter less its margins is 718 px wide, and has no scroll bar."""
    page, _, _ = opened(718)
    page.emulate_media(media="print")
    wide = page.evaluate("""[...document.querySelectorAll("table")].filter(table => table.offsetParent !== null
        && table.getBoundingClientRect().right > document.documentElement.clientWidth).map(table => table.innerText)""")
    assert page.locator("table").count() > 3 and wide == []


def test_colours_follow_a_change_of_scheme(opened):
    page, _, _ = opened(scheme="light")
    look = "document.querySelector('.uplot canvas').toDataURL()"
    light = page.evaluate(look)
    page.emulate_media(color_scheme="dark")
    eventually(page, lambda: page.evaluate(look) != light)


def test_the_keyboard_reaches_headers_and_buttons(opened):
    page, _, _ = opened()
    head = page.locator("#ranking th").first
    head.focus()
    page.keyboard.press("Enter")
    eventually(page, lambda: head.get_attribute("aria-sort") is not None)
    page.get_by_role("button", name="zoom in").first.focus()
    page.keyboard.press("Enter")


def test_the_animation_plays_and_can_be_put_to_any_time(opened):
    page, said, _ = opened()
    player = page.locator("figure.animation")
    player.get_by_role("slider").fill("60")
    assert player.locator("output").inner_text() == "2.00 s"
    look = "document.querySelector('figure.animation canvas').toDataURL()"
    before = page.evaluate(look)
    player.get_by_role("button", name="play").click()
    eventually(page, lambda: float(player.locator("output").inner_text().removesuffix(" s")) > 2.2)
    assert page.evaluate(look) != before and said == []
