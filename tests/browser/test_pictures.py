"""Pictures of the live view for the documentation. LIVE_PICTURES names their folder; otherwise it is a temporary one."""

from __future__ import annotations

import io
import os
from pathlib import Path

import pytest
from PIL import Image

SIZE = {"width": 1280, "height": 760}


@pytest.fixture
def folder(tmp_path) -> Path:
    return Path(os.environ.get("LIVE_PICTURES") or tmp_path)


def office(live, visit, **options):
    """A page of a robot that drifts in an office, with obstacles, on its way to a goal."""
    parameters = ["laser_frequency:=20", "odometry_alphas:=[0.15,0.05,0.05,0.15,0,0]", "speed_factor:=2"]
    process = live("--seed", 4, "--start", 10.2, 5.6, 0, *(word for each in parameters for word in ("-p", each)))
    page = visit(process.url, **{"viewport": SIZE, **options})
    for start, end in [((18.0, 6.1), (18.4, 6.1)), ((24.0, 5.0), (24.25, 5.0))]:
        page.drag("disc", start, end)
    page.drag("box", (20.7, 5.2), (21.3, 5.9))
    page.drag("goal", (28.0, 14.5), (28.0, 16.0))
    page.tab.keyboard.press("Escape")
    page.tab.mouse.move(700, 745)
    return page


def image_of(page) -> Image.Image:
    return Image.open(io.BytesIO(page.tab.screenshot())).convert("RGB")


def save(image: Image.Image, file: Path) -> None:
    image.quantize(256, dither=Image.Dither.NONE).save(file, optimize=True)


@pytest.mark.parametrize("look", ["light", "dark"])
def test_the_page_in_light_and_dark(live, visit, folder, look):
    page = office(live, visit, color_scheme=look)
    if page.get("document.body.classList.contains('body--dark')") != (look == "dark"):
        page.test("dark").click()
    page.tab.mouse.move(700, 745)
    page.wait("live.link().trails[''].length > 480")
    page.tab.wait_for_timeout(200)
    image = image_of(page)
    save(image, folder / f"live_{look}.png")
    corner = image.getpixel((60, 300))
    assert (sum(corner) > 600) == (look == "light")


def test_a_drive_as_moving_picture(live, visit, folder):
    page = office(live, visit, viewport={"width": 960, "height": 600})
    page.test("panel").click() if page.test("side").count() else None
    page.tab.wait_for_timeout(200)
    page.get("live.fit()")
    frames = []
    for _ in range(36):
        frames.append(image_of(page).resize((640, 400), Image.Resampling.LANCZOS))
        page.tab.wait_for_timeout(150)
    colours = frames[20].quantize(255, dither=Image.Dither.NONE)
    small = [frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
    small[0].save(folder / "live.gif", save_all=True, append_images=small[1:], duration=160, loop=0, optimize=True)
    with Image.open(folder / "live.gif") as moving:
        assert moving.n_frames > 20
    assert len({frame.tobytes() for frame in frames}) > 20
