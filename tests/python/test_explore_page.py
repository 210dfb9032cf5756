"""The page `rbsdem explore` in a real browser: it draws, drags, exports and refuses bad input."""

from __future__ import annotations

import copy
import csv
import re
import shutil
import threading
import time
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

import rbsdem
from rbsdem.web.report import write_report
from rbsdem.web.server import ExploreServer
from rbsdem.web.state import DEFAULT

selenium = pytest.importorskip("selenium", reason="selenium is not installed (extra test)")
from selenium import webdriver  # noqa: E402
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402
from selenium.webdriver.support.ui import Select  # noqa: E402

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 15.0

# A short path, so that an answer takes no time on a busy machine.
START = copy.deepcopy(DEFAULT)
START["cases"][0][-1][1].update(amplitudes=[0.005, 0.02], cycles=[1])


class Page:
    """What a test does on the page."""

    def __init__(self, driver, address: str, downloads: Path) -> None:
        self.driver, self.address, self.downloads = driver, address, downloads

    def open(self, address: str | None = None) -> None:
        self.driver.get("about:blank")
        self.driver.get(address or self.address)
        self.wait(lambda: self.all("#loopfigure path.line.a"))

    def all(self, selector: str):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def one(self, selector: str):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def value(self, selector: str) -> str:
        return self.one(selector).get_property("value")

    def text(self, selector: str) -> str:
        return self.driver.execute_script(
            "return document.querySelector(arguments[0]).textContent", selector
        )

    def type(self, selector: str, words: str) -> None:
        field = self.one(selector)
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(words or Keys.DELETE, Keys.TAB)

    def wait(self, done: Callable[[], object]) -> None:
        """Wait until something is true; an element that is drawn anew meanwhile is not yet."""
        until = time.monotonic() + PATIENCE
        while True:
            try:
                if done():
                    return
            except selenium.common.exceptions.StaleElementReferenceException:
                pass
            assert time.monotonic() < until, self.text("body")[:2000]
            time.sleep(0.02)

    def peak(self) -> float:
        """The largest force, as the table has it [kN]."""
        row = self.text("#figures tbody tr td")
        return float(row.split()[0])

    def old(self) -> set[str]:
        """The panels that are marked as those of an earlier input."""
        return {one.get_attribute("id") for one in self.all(".old")}

    def saved(self, name: str) -> bytes:
        path = self.downloads / name
        self.wait(path.is_file)
        return path.read_bytes()


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None or shutil.which("chromedriver") is None:
        pytest.skip("no chromium with its driver; apt-get install chromium chromium-driver")
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(shutil.which("chromedriver"))
    found = webdriver.Chrome(options=options, service=service)
    folder = tmp_path_factory.mktemp("downloads")
    found.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder)}
    )
    found.downloads = folder
    yield found
    found.quit()


@pytest.fixture(scope="module")
def address():
    with ExploreServer(0, START) as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}).start()
        yield server.address
        server.shutdown()


@pytest.fixture
def unopened(driver, address):
    driver.get_log("browser")
    size(driver, 1280, 900)
    yield Page(driver, address, driver.downloads)
    driver.execute_script("sessionStorage.clear()")  # the next one begins anew
    # Nothing that the policy of the page forbids, and no error of a script.
    assert driver.get_log("browser") == []


@pytest.fixture
def page(unopened):
    unopened.open()
    return unopened


def size(driver, width: int, height: int, scheme: str = "light") -> None:
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600},
    )
    driver.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
    )


def test_a_drag_is_one_step_and_a_link(page):
    before = page.peak()
    handle = page.one('[data-path="section.depth"] .knob')
    mouse = ActionChains(page.driver, duration=20)
    mouse.click_and_hold(handle).move_by_offset(0, 8).move_by_offset(0, 8).release().perform()
    page.wait(lambda: page.value("#f-section-depth") != "400" and page.peak() > before)
    depth = page.value("#f-section-depth")
    assert float(depth) > 420
    link = page.driver.current_url
    page.one("#undo").click()
    page.wait(lambda: page.value("#f-section-depth") == "400" and page.peak() == before)
    assert not page.one("#undo").is_enabled()
    page.one("#redo").click()
    page.wait(lambda: page.value("#f-section-depth") == depth)
    page.open(link)
    assert page.value("#f-section-depth") == depth


def test_keys_move_a_handle_and_a_field(page):
    handle = page.one('#drawings [data-path="section.width"]')
    page.driver.execute_script("arguments[0].focus()", handle)
    keys = ActionChains(page.driver)
    keys.send_keys(Keys.ARROW_UP).send_keys(Keys.ARROW_UP).perform()
    page.wait(lambda: page.value("#f-section-width") == "420")
    focused = (
        "return ['label', 'valuetext'].map(n => document.activeElement.getAttribute('aria-' + n))"
    )
    page.wait(lambda: page.driver.execute_script(focused) == ["Width", "420 mm"])
    page.one("#f-column-axial_load").send_keys(Keys.ARROW_UP)
    page.wait(lambda: page.value("#f-column-axial_load") == "754")
    # Every field has a label, every button and handle a name.
    nameless = page.driver.execute_script(
        "return [...document.querySelectorAll('input:not([hidden]), select, textarea')]"
        ".filter(e => !e.labels.length).map(e => e.id)"
    )
    assert nameless == []


def test_errors_stand_in_the_units_of_their_fields_and_go(page):
    page.type("#f-layout-number", "11")
    page.wait(lambda: page.text("#f-layout-number-fault").startswith("Number = 11 does not spread"))
    assert page.one("#f-layout-number-fault").is_displayed()
    assert page.one("#f-layout-number").get_attribute("aria-invalid") == "true"
    assert "f-layout-number-fault" in page.one("#f-layout-number").get_attribute("aria-describedby")
    assert "does not spread" in page.text("#live")
    page.type("#f-layout-number", "twelve")
    page.wait(lambda: "'twelve' must be a whole number" in page.text("#f-layout-number-fault"))
    page.type("#f-layout-number", "16")
    page.wait(lambda: not page.one("#f-layout-number-fault").is_displayed())
    page.wait(lambda: not page.old())
    for selector, typed, units, told in (
        ("concrete-fc", "500", "in", "Concrete strength = 500 ksi must be from 0.72519 to 29.008"),
        ("concrete-fc", "", "mm", "Concrete strength: give a value in MPa"),
        ("column-axial_load", "100000", "mm", "give −1129.9 to 8844.6 kN"),
        ("loading-amplitudes", "-2", "mm", "Drifts = −2 % must be above zero"),
    ):
        Select(page.one("#units")).select_by_value(units)
        page.type(f"#f-{selector}", typed)
        page.wait(lambda at=selector, told=told: told in page.text(f"#f-{at}-fault"))
        assert page.one(f"#f-{selector}-fault").is_displayed()
        page.open()


def test_what_stands_belongs_to_one_accepted_input(page):
    panels = ("#figures", "#statetable", "#curvaturefigure", "#interactionfigure", "#codetable")

    def now() -> list[str]:
        return [page.text(panel) for panel in panels]

    page.wait(lambda: page.text("#codetable") and not page.old())
    # Letter by letter: 5 mm of width are refused, 52 mm too, 520 mm are a column.
    page.type("#f-section-width", "520")
    page.wait(lambda: page.value("#f-section-width") == "520" and not page.old())
    page.wait(lambda: "joint of the model" in page.text("#interactionfigure"))
    page.wait(lambda: "band of 80 %" in page.text("#loopstate"))
    accepted = now()
    page.type("#f-section-cover", "-1")  # letter by letter refused
    page.wait(lambda: "is refused" in page.text("#loopstate"))
    every = {"loops", "summary", "states", "history", "curvature", "interaction", "codes"}
    assert page.old() == every
    assert now() == accepted
    for panel in ("#loopfigure svg", "#figures table", "#curvaturefigure svg", "#codetable table"):
        page.wait(lambda panel=panel: float(page.one(panel).value_of_css_property("opacity")) < 0.5)
    page.one('[title="Save loop.svg"]').click()
    page.wait(lambda: "Nothing is saved" in page.text("#notes"))
    page.type("#f-section-cover", "13")
    page.wait(lambda: not page.old() and now() == accepted)
    # Tension: what codes have no value for says so, and all else stands.
    page.type("#f-column-axial_load", "-744")
    page.wait(lambda: "is tension, which" in page.text("#codetable"))
    page.wait(lambda: not page.old())
    assert page.all("#curvaturefigure path.line.a")


def test_units_are_a_way_to_look(page):
    before = page.driver.execute_script("return location.hash")
    Select(page.one("#units")).select_by_value("in")
    # Five digits of what was typed in other units, which stays what it is.
    assert page.value("#f-section-width") == "15.748"
    assert page.value("#f-column-axial_load") == "167.26"
    page.type("#f-section-width", "20")
    page.wait(lambda: page.one("#undo").is_enabled())
    Select(page.one("#units")).select_by_value("mm")
    assert page.value("#f-section-width") == "508"
    assert page.driver.execute_script("return location.hash") != before


def test_two_columns_and_another_loading(page):
    page.one("#second").click()
    page.wait(lambda: page.all("#loopfigure path.line.b"))
    assert len(page.all("#drawings svg")) == 2
    page.type("#f-column-axial_load", "2000")
    page.wait(lambda: len(page.all("#figures thead th")) == 3)
    page.one("#second").click()
    page.wait(lambda: not page.all("#loopfigure path.line.b"))
    Select(page.one("#f-loading-kind")).select_by_value("synthetic")
    page.wait(lambda: page.all("#timefigure path.line.a") and page.all("#scalefigure path.line.a"))


def test_exports(page):
    page.wait(lambda: page.all("#loopfigure .band path"))
    assert "band of 80 %" in page.text("#loopstate")
    for form, ending in (("namelist", "nml"), ("csv", "csv")):
        Select(page.one("#export")).select_by_value(form)
        assert page.saved(f"column_a.{ending}")
    case = rbsdem.read_case(page.downloads / "column_a.nml")
    assert 1e-3 * abs(case.run().force).max() == pytest.approx(page.peak(), rel=1e-3)
    # A file comes back as the drawing that it was.
    page.type("#f-section-width", "450")
    page.wait(lambda: page.one("#undo").is_enabled())
    page.one("#file").send_keys(str(page.downloads / "column_a.nml"))
    page.wait(lambda: page.value("#f-section-width") == "400")


def test_every_panel_is_saved(page):
    page.wait(lambda: page.all("#interactionfigure path.line.dotted") and not page.old())
    panels = [one for one in page.all("main > section") if one.is_displayed()][1:]
    assert all(panel.find_elements(By.CSS_SELECTOR, ".saves button") for panel in panels)
    texts = {}
    for button in page.all(".saves button"):
        if button.is_displayed():
            name = button.get_attribute("title").removeprefix("Save ")
            button.click()
            texts[name] = page.saved(name)
    assert len(texts) == 14
    for name, raw in texts.items():
        if name.endswith("svg"):
            assert "handle" not in raw.decode()
            size = ElementTree.fromstring(raw).attrib
            assert int(size["width"]) > 200
        elif name.endswith("png"):
            assert raw.startswith(b"\x89PNG")
    loop, states, codes = (
        list(csv.reader(texts[f"{name}.csv"].decode().splitlines()))
        for name in ("loop", "limit_states", "codes")
    )
    assert loop[0] == ["series", "Drift (%)", "Lateral force (kN)"]
    assert max(float(row[2]) for row in loop[1:] if row[0] == "a") == pytest.approx(
        page.peak(), rel=1e-3
    )
    assert states[0] == ["First reached", "drift %", "d mm", "F kN", "criterion"]
    assert all(len(row) == 5 for row in states + codes)


def test_values_under_the_pointer_and_legends(page):
    page.wait(lambda: page.all("#interactionfigure path.line.dotted"))
    legend = [one.get_attribute("textContent") for one in page.all("#curvaturefigure .legend text")]
    assert legend[:3] == ["not confined", "core confined", "cracking"]
    assert "largest moment of the loop" in page.text("#interactionfigure .legend")
    for figure, told in (("loopfigure", r"[\d.−]+ %, [\d.−]+ kN"), ("curvaturefigure", "mrad/m, ")):
        line = page.one(f"#{figure} path.line.a")
        at = page.driver.execute_script(
            "const p = arguments[0].getPointAtLength(9), b = arguments[0].ownerSVGElement"
            ".getBoundingClientRect(); arguments[0].scrollIntoView({block: 'center'});"
            "return [p.x - b.width / 2, p.y - b.height / 2]",
            line,
        )
        mouse = ActionChains(page.driver, duration=0)
        svg = page.one(f"#{figure} svg")
        mouse.move_to_element_with_offset(svg, round(at[0]), round(at[1])).perform()
        page.wait(lambda of=figure, words=told: re.search(words, page.text(f"#{of} .probe")))
        assert page.one(f"#{figure} .probe").get_attribute("visibility") == "visible"


def test_bars_step_through_their_sizes(page):
    handle = page.one('#drawings [data-path="layout.diameter"]')
    page.driver.execute_script("arguments[0].focus()", handle)
    keys = ActionChains(page.driver)
    keys.send_keys(Keys.ARROW_UP).send_keys(Keys.ARROW_UP).perform()
    page.wait(lambda: page.value("#f-layout-diameter") == "25")
    page.one("#f-ties-diameter").send_keys(Keys.ARROW_UP)  # from 7 mm, which is no size
    page.wait(lambda: page.value("#f-ties-diameter") == "8")
    Select(page.one("#units")).select_by_value("in")
    page.one("#f-layout-diameter").send_keys(Keys.ARROW_DOWN)
    page.wait(lambda: page.value("#f-layout-diameter") == "0.875")


def test_a_footing_is_drawn_and_turns(page):
    before = page.peak()
    Select(page.one("#f-footing-kind")).select_by_value("springs")
    page.wait(lambda: page.all("#drawings .spring") and page.peak() != before)
    page.type("#f-flexure-k", "")
    page.wait(lambda: "give a value in kN m/rad" in page.text("#f-flexure-k-fault"))
    page.type("#f-flexure-k", "50000")
    page.wait(lambda: not page.old())
    page.open(page.driver.current_url)
    assert page.value("#f-flexure-k") == "50000"


def test_a_record_says_which_file_it_takes(page):
    Select(page.one("#f-loading-kind")).select_by_value("record")
    page.wait(lambda: page.text("#f-loading-file-fault") == "choose a file")
    assert ".at2" in page.text("#f-loading-file-hint")


def test_fields_stay_beside_a_long_page(page):
    page.wait(lambda: page.all("#codetable td"))
    page.driver.execute_script("window.scrollTo(0, document.body.scrollHeight)")
    page.wait(
        lambda: (
            0
            <= page.one("#f-section-width").rect["y"] - page.driver.execute_script("return scrollY")
            < 300
        )
    )


def test_a_small_screen_and_the_dark(page):
    light = "return getComputedStyle(document.body).backgroundColor"
    for scheme, dark in (("dark", True), ("light", False)):
        size(page.driver, 390, 844, scheme)
        paper = page.driver.execute_script(light)
        assert (sum(int(part) for part in paper[4:-1].split(",")) < 380) == dark
    page.wait(lambda: page.one("#loopfigure svg").size["width"] < 390)
    assert page.driver.execute_script("return document.documentElement.scrollWidth") <= 390
    page.one("#second").click()
    page.wait(lambda: len(page.all("#codetable tr:first-child th")) == 6)
    # In one go, as tables are drawn anew when the band comes.
    beyond = (
        "return [...document.querySelectorAll('.scroll')].filter(table => table.clientWidth)"
        ".map(table => table.scrollWidth - table.clientWidth)"
    )
    page.wait(lambda: page.driver.execute_script(beyond) == [0, 0, 0])


@pytest.fixture
def frame(page):
    """The view of frames, with the answer to its input and to its demand."""
    page.all("#views button")[1].click()
    page.wait(lambda: page.all("#membertable tbody tr") and page.text("#attarget"))
    page.wait(lambda: not page.old())
    return page


def test_a_frame_is_pushed_and_its_hinges_show(frame):
    page = frame
    assert len(page.all("#frame .member")) == 15
    page.one("#play").click()
    page.wait(lambda: page.value("#scrub") == page.one("#scrub").get_attribute("max"))
    assert page.all("#frame .hinge.yielded")[1:]
    assert page.text("#scrubbed").startswith("3 %")
    assert not page.all("#statetable tr.later")
    # The target displacement, with the levels that each end exceeds.
    page.one("#attarget").click()
    assert "exceeds NC" in page.text("#frame")
    assert page.all("#statetable tr.later")
    assert len(page.all("#storeytable tbody tr")) == 3
    # Forces and ratio of a member under the pointer.
    ActionChains(page.driver).move_to_element(page.all("#frame .member")[-1]).perform()
    told = page.text("#told")
    page.wait(lambda: re.match(r"[BC]-\d-\d: N .* kN, V .* kN, M .*over capacity", told))


def test_a_member_of_a_frame_is_removed_and_comes_back(frame):
    page, before = frame, frame.text("#figures")
    element = page.one('#frame [data-name="B-1-2"]')
    page.driver.execute_script("arguments[0].focus()", element)
    element.send_keys(Keys.DELETE)
    page.wait(lambda: page.all("#frame .removed") and page.text("#figures") != before)
    assert page.text("#remove") == "Put B-1-2 back"
    assert len(page.all("[id^=f-beam_of-][id$=kind]")) == 2  # a rule: none in bay 1 of storey 2
    page.one("#remove").click()
    page.wait(lambda: page.text("#figures") == before and not page.all("#frame .removed"))
    page.one("#undo").click()
    page.wait(lambda: page.all("#frame .removed"))
    # Columns and back keep both; so does another visit of the tab.
    page.all("#views button")[0].click()
    page.wait(lambda: page.all("#codetable tbody tr"))
    page.type("#f-section-width", "450")
    page.driver.refresh()
    page.wait(lambda: page.all("#loopfigure path.line.a"))
    assert page.value("#f-section-width") == "450"
    page.all("#views button")[1].click()
    page.wait(lambda: page.all("#frame .removed"))


def test_a_building_in_plan_shows_one_frame_at_a_time(frame, tmp_path):
    page = frame
    page.type("#f-frame-storeys", "3200")
    page.one("#setinplan").click()
    page.wait(lambda: len(page.all("#plan .member")) == 5)
    page.wait(lambda: not page.old() and page.text("#attarget"))
    page.wait(lambda: len(page.all("#frame .member")) == 5)
    along_x = page.text("#figures")
    line = page.one('#plan [data-name="y-2"]')
    page.driver.execute_script("arguments[0].focus()", line)
    line.send_keys(Keys.ENTER)
    page.wait(lambda: len(page.all("#frame .member")) == 3)
    assert page.text("#figures").split("roof drift at")[0] == along_x.split("roof drift at")[0]
    # A beam of this line alone is removed; the case says where.
    beam = page.one('#frame [data-name="B-1-1"]')
    page.driver.execute_script("arguments[0].focus()", beam)
    beam.send_keys(Keys.DELETE)
    page.wait(lambda: page.all("#frame .removed"))
    keys = ("along", "bay", "of_line", "storey", "kind")
    cells = [page.value(f"#f-beam_of-3-{key}") for key in keys]
    assert cells == ["y", "1", "2", "1", "none"]
    page.one("#undo").click()
    page.wait(lambda: not page.all("#frame .removed"))
    # A record along x, which moves no frame along y, and then another one along y
    Select(page.one("#f-loading-kind")).select_by_value("record")
    page.wait(lambda: page.all("#f-loading-file_y"))
    record = tmp_path / "short.csv"
    record.write_text("time_s,acceleration_g\n" + "".join(f"{0.02 * i},0.2\n" for i in range(9)))
    for key in ("file", "file_y"):
        page.one(f"#f-loading-{key}").click()
        page.one("#recordfile").send_keys(str(record))
        page.wait(lambda: page.text(f"#f-loading-{key}") == "short.csv")  # noqa: B023
    # The largest shear of the frame along y, which is shown

    def largest():
        cells = [cell.text.replace("−", "-") for cell in page.all("#storeytable td")]
        return float(cells[3]) if len(cells) > 3 and not page.old() else 0.0

    page.wait(lambda: largest() > 1.0)


def test_a_building_is_drawn_by_its_fields(frame):
    """Outer columns of another concrete, rows at the sides, facades, a wall, masonry, a lap."""
    page = frame
    page.type("#f-frame-storeys", "3400, 3000")
    page.wait(lambda: len(page.all("#frame .member")) == 10)
    page.all("#tabs button")[1].click()
    page.one("#add-section").click()
    assert page.value("#f-drawing-name") == "C2"
    page.type("#f-drawing-name", "outer")
    page.type("#f-concrete-fc", "35")
    Select(page.one("#f-bars-kind")).select_by_value("row")
    page.one("#add-row").click()
    page.type("#f-row-3-number", "1")
    page.type("#f-lap-length", "700")
    page.one("#add-section").click()
    page.type("#f-drawing-name", "W1")
    Select(page.one("#f-section-shape")).select_by_value("wall")
    page.wait(lambda: page.all("#f-boundary-length") and page.all("#f-curtain-2-spacing"))
    page.all("#tabs button")[0].click()
    page.one("#add-column_of").click()
    Select(page.one("#f-column_of-2-kind")).select_by_visible_text("outer")
    page.one("#add-column_of").click()
    Select(page.one("#f-column_of-3-line")).select_by_value("2")
    Select(page.one("#f-column_of-3-kind")).select_by_visible_text("W1")
    page.one("#add-node_load").click()
    page.type("#f-node_load-2-load", "20")
    page.one("#add-infill").click()
    page.one("#add-infill_of").click()
    Select(page.one("#f-infill_of-1-bay")).select_by_value("1")
    page.wait(lambda: not page.old() and len(page.all("#drawings svg")) == 4)
    page.wait(lambda: "target displacement" in page.text("#figures"))
    # No code has limits of walls; all else stands.
    (fault,) = page.all("#notes .fault")
    assert "no limits of walls are known" in fault.text
    page.one("#export").send_keys("case")
    page.saved("frame.nml")
    case = rbsdem.read_case(page.downloads / "frame.nml")
    (page.downloads / "frame.nml").unlink()
    building = case.column.drawing
    assert set(building.node_load.values()) == {20e3}
    sections = {type(one).__name__ for one in building.columns.values()}
    assert sections == {"RectangularSection", "WallSection"}
    outer = next(one for one in building.columns.values() if getattr(one, "lap", None))
    assert (outer.concrete.fc, outer.lap.length, outer.side.number) == (35e6, 0.7, 1)
    assert building.infills


def test_fields_of_a_frame_are_those_of_its_sections(frame):
    page = frame
    page.all("#tabs button")[2].click()
    page.type("#f-section-width", "-1")
    page.wait(lambda: "Width = −1 mm must be above" in page.text("#f-section-width-fault"))
    assert "states" in page.old()
    # From another tab the message has the name of its section.
    page.all("#tabs button")[0].click()
    assert "B1: Width = −1 mm" in page.text("#notes")
    assert "Width" in page.text("#live")
    page.all("#tabs button")[2].click()
    page.type("#f-section-width", "300")
    page.wait(lambda: not page.old())
    page.wait(lambda: page.text("#live") == "")  # the error of a half-typed number goes
    # Dragging the beam's depth, by keys.
    handle = page.one('#drawings [data-column="B1"] [data-path="section.depth"]')
    handle.send_keys(Keys.ARROW_UP)
    page.wait(lambda: page.value("#f-section-depth") == "510")
    page.all("#tabs button")[0].click()
    page.type("#f-target-ag", "")
    page.wait(lambda: "give a number" in page.text("#f-target-ag-fault"))
    page.type("#f-target-ag", "0.1")
    page.wait(lambda: not page.old())
    page.one("#export").send_keys("case")
    text = page.saved("frame.nml").decode()
    assert "&row face = 'top'" in text
    (page.downloads / "frame.nml").unlink()


def test_a_frame_in_an_earthquake_and_on_a_small_screen(frame):
    page = frame
    page.type("#f-frame-storeys", "3200, 3200")
    page.type("#f-frame-bays", "6000")
    Select(page.one("#f-loading-kind")).select_by_value("synthetic")
    page.wait(lambda: page.all("#timefigure path.line.b") and not page.old())
    assert "residual storey drift" in page.text("#figures")
    assert "largest of all rows" in page.text("#membertable")
    size(page.driver, 390, 844)
    page.wait(lambda: page.one("#frame svg").size["width"] < 390)
    assert page.driver.execute_script("return document.documentElement.scrollWidth") <= 390


def test_a_report_asks_nothing(unopened, tmp_path):
    page = unopened
    path = write_report(tmp_path / "report.html", START, "A pier")
    page.open(path.as_uri())
    assert "A pier" in page.text("h1")
    assert page.all("#loopfigure .band path")
    assert page.all("#codetable tbody tr")
    assert page.one("#f-section-width").get_property("readOnly")
    asked = (
        "return performance.getEntriesByType('resource').filter(e => !e.name.startsWith('data:'))"
    )
    assert page.driver.execute_script(asked) == []


def test_a_server_that_has_ended(page):
    page.driver.execute_cdp_cmd("Network.enable", {})
    lost = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
    page.driver.execute_cdp_cmd("Network.emulateNetworkConditions", lost)
    page.type("#f-section-width", "500")
    page.wait(lambda: "the server has ended" in page.text("#loopstate"))
    page.driver.execute_cdp_cmd("Network.disable", {})
    page.driver.get_log("browser")  # that nothing was reached
