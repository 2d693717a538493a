"""map_files and map_image: pixels become cells as in nav2_map_server, and saved maps load unchanged."""

from __future__ import annotations

import io
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image, ImageFile

import mobile_robot_simulator as mrs
from map_folders import CARRIED_MAPS, SHARED_MAPS, maps, needs_real_maps

Expected = dict[str, tuple[tuple[int, int], float, tuple[float, float, float], tuple[int, int, int]]]

ENTRIES = {
    "image": "map.pgm",
    "resolution": "0.05",
    "origin": "[-1.5, 2.0, 0.25]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}


def write_yaml(folder: Path, /, **entries: str | None) -> Path:
    """Writes the YAML file of a map and returns its path. Entries that are None are omitted."""
    path = folder / "map.yaml"
    lines = [f"{key}: {text}\n" for key, text in {**ENTRIES, **entries}.items() if text is not None]
    path.write_text("".join(lines))
    return path


def write_map(folder: Path, image: bytes, /, **entries: str | None) -> Path:
    """Writes an image and the YAML file of a map, and returns the path of the YAML file."""
    (folder / "map.pgm").write_bytes(image)
    return write_yaml(folder, **entries)


def pgm(rows: list[list[int]]) -> bytes:
    return b"P5\n%d %d\n255\n" % (len(rows[0]), len(rows)) + np.array(rows, np.uint8).tobytes()


def encoded(image: Image.Image, image_format: str, **options: Any) -> bytes:
    file = io.BytesIO()
    image.save(file, image_format, **options)
    return file.getvalue()


def grey_image(rows: list[list[int]]) -> Image.Image:
    return Image.fromarray(np.array(rows, np.uint8))


def big_endian(samples: list[int]) -> bytes:
    return np.array(samples, ">u2").tobytes()


def cells_of(path: Path) -> list[list[int]]:
    cells: list[list[int]] = mrs.load_map(path).cells.tolist()
    return cells


def greys_of(folder: Path, image: bytes) -> list[list[int]]:
    """Greys of an image, top row first, read with mode raw. All must be at most 100."""
    return cells_of(write_map(folder, image, mode="raw"))[::-1]


# --- From pixels to cells: hand-derived tables ---


def test_trinary_has_three_values_and_the_bottom_row_comes_first(tmp_path: Path) -> None:
    image = pgm([[0, 254, 205], [206, 89, 90]])  # p: 1, 0.004, 0.19608; 0.192, 0.651, 0.647
    assert cells_of(write_map(tmp_path, image)) == [[0, 100, -1], [100, 0, -1]]
    assert cells_of(write_map(tmp_path, image, mode="trinary")) == [[0, 100, -1], [100, 0, -1]]


def test_grey_205_is_unknown_at_0_196_and_free_at_0_25(tmp_path: Path) -> None:
    assert cells_of(write_map(tmp_path, pgm([[205]]), free_thresh="0.196")) == [[-1]]
    assert cells_of(write_map(tmp_path, pgm([[205]]), free_thresh="0.25")) == [[0]]


def test_the_thresholds_themselves_are_occupied_and_free(tmp_path: Path) -> None:
    # 0.6 is 153/255 and 0.2 is 51/255.
    path = write_map(tmp_path, pgm([[102, 103, 203, 204]]), occupied_thresh="0.6", free_thresh="0.2")
    assert cells_of(path) == [[100, -1, -1, 0]]


def test_equal_thresholds_leave_nothing_unknown(tmp_path: Path) -> None:
    entries = {"occupied_thresh": "0.6", "free_thresh": "0.6"}
    for mode in ("trinary", "scale"):
        assert cells_of(write_map(tmp_path, pgm([[102, 103]]), mode=mode, **entries)) == [[100, 0]]


@pytest.mark.parametrize("negate", ["1", "true", "True"])
def test_negate_makes_white_occupied(tmp_path: Path, negate: str) -> None:
    path = write_map(tmp_path, pgm([[0, 254, 205, 51, 153, 100]]), negate=negate, free_thresh="0.2")
    assert cells_of(path) == [[0, 100, 100, 0, -1, -1]]


def test_scale_is_linear_between_the_thresholds_and_rounds(tmp_path: Path) -> None:
    image = pgm([[102, 103, 152, 153, 178, 203, 204, 255]])
    path = write_map(tmp_path, image, mode="scale", occupied_thresh="0.6", free_thresh="0.2")
    # (255 - grey - 51) / 102: 1, 0.990, 0.510, 0.5, 0.255, 0.0098, 0, below 0
    assert cells_of(path) == [[100, 99, 51, 50, 25, 1, 0, 0]]


def test_raw_uses_the_grey_and_ignores_negate(tmp_path: Path) -> None:
    image = pgm([[0, 1, 99, 100, 101, 127, 128, 255]])
    for negate in ("0", "1"):
        assert cells_of(write_map(tmp_path, image, mode="raw", negate=negate)) == [[0, 1, 99, 100, -1, -1, -1, -1]]


@pytest.mark.parametrize("mode", ["LA", "RGBA"])
def test_pixels_that_are_not_opaque_are_unknown_except_in_raw(tmp_path: Path, mode: str) -> None:
    image = grey_image([[0, 0, 254], [0, 254, 50]]).convert(mode)
    image.putalpha(grey_image([[0, 254, 255], [255, 128, 255]]))
    data = encoded(image, "PNG")
    assert cells_of(write_map(tmp_path, data)) == [[100, -1, 100], [-1, -1, 0]]
    assert cells_of(write_map(tmp_path, data, mode="scale")) == [[100, -1, 100], [-1, -1, 0]]
    assert cells_of(write_map(tmp_path, data, mode="raw")) == [[0, -1, 50], [0, 0, -1]]


def test_transparency_can_be_averaged_with_the_colours_as_before_april_2025(tmp_path: Path) -> None:
    """The shade is (3 * grey + alpha) / 1020: a black pixel is 1 occupied if it is transparent, 0.75 if it is opaque."""
    image = grey_image([[0, 0, 254, 254], [0, 60, 100, 205]]).convert("LA")
    image.putalpha(grey_image([[0, 255, 0, 255], [128, 255, 255, 255]]))
    path = write_map(tmp_path, encoded(image, "PNG"))
    # Occupied from 0.65, free up to 0.196: 1, 0.75, 0.25, 0.003; 0.87, 0.57, 0.46, 0.15.
    assert mrs.load_map(path, transparency="averaged").cells[::-1].tolist() == [[100, 100, -1, 0], [100, -1, -1, 0]]
    assert mrs.load_map(path).cells[::-1].tolist() == [[-1, 100, -1, 0], [-1, 100, -1, -1]]
    opaque = write_map(tmp_path, pgm([[0, 254]]))
    assert mrs.load_map(opaque, transparency="averaged").cells.tolist() == [[100, 0]]
    with pytest.raises(ValueError, match="transparency must be 'unknown' or 'averaged', got 'no'"):
        mrs.load_map(opaque, transparency="no")  # type: ignore[arg-type]


def test_transparent_values_of_a_png_without_alpha_are_unknown(tmp_path: Path) -> None:
    grey = grey_image([[0, 7, 8]])
    sixteen = Image.fromarray(np.array([[0, 7 * 257, 7 * 257 + 1]], np.uint16))
    for data in (
        encoded(grey, "PNG", transparency=7),
        encoded(grey.convert("P"), "PNG", transparency=7),
        encoded(grey.convert("RGB"), "PNG", transparency=(7, 7, 7)),
        encoded(sixteen, "PNG", transparency=7 * 257),
    ):
        assert cells_of(write_map(tmp_path, data)) == [[100, -1, 100]]


def test_luma_equals_that_of_graphicsmagick(tmp_path: Path) -> None:
    # (306 R + 601 G + 117 B) / 1024: 76.2, 58.7, 29.1, 62.1, 77: rounded down.
    colours = [(255, 0, 0), (0, 100, 0), (0, 0, 255), (100, 50, 25), (77, 77, 77)]
    image = Image.fromarray(np.array([colours], np.uint8))
    assert greys_of(tmp_path, encoded(image, "PNG")) == [[76, 58, 29, 62, 77]]
    assert greys_of(tmp_path, encoded(image, "PPM")) == [[76, 58, 29, 62, 77]]
    assert greys_of(tmp_path, b"P3\n5 1\n255\n255 0 0 0 100 0 0 0 255 100 50 25 77 77 77") == [[76, 58, 29, 62, 77]]


def test_grey_colours_keep_their_grey(tmp_path: Path) -> None:
    greys = list(range(256))
    expected = [[grey if grey <= 100 else -1 for grey in greys]]
    assert greys_of(tmp_path, encoded(grey_image([greys]).convert("RGB"), "PNG")) == expected


# --- Encodings ---

SAMPLES = bytes([0, 50, 100, 10, 35, 9])  # in ASCII, 10 is a line feed, 35 a number sign, 9 a tab
SAMPLES_THRICE = bytes(sample for sample in SAMPLES for _ in range(3))
GREYS = [[0, 50, 100], [10, 35, 9]]


@pytest.mark.parametrize(
    "image",
    [
        pytest.param(b"P5\n3 2\n255\n" + SAMPLES, id="plain"),
        pytest.param(b"P5 3\t2  255 " + SAMPLES, id="one line"),
        pytest.param(b"P5\r\n3 2\r\n255\n" + SAMPLES, id="CRLF"),
        pytest.param(b"P5\n#\n# 7 7\n3 # w\n#\n2\n# 1\n255\n" + SAMPLES, id="comments on separate lines"),
        pytest.param(b"P5# a\n3# b\r2# c\n255# d\n" + SAMPLES, id="comments right after the fields"),
        pytest.param(b"P5\n3 2\n255\n" + SAMPLES + b"\nP5 and so on", id="trailing bytes"),
        pytest.param(b"P6\n3 2\n255\n" + SAMPLES_THRICE, id="colour"),
        pytest.param(b"P2\n3 2\n255\n0 50 100\n10 35 9\n", id="ASCII"),
        pytest.param(b"P2 3 2 255\r\n0\r\n50\r\n100\r\n10\r\n35\r\n9", id="ASCII, one a line"),
        pytest.param(b"P2\n3 2 255\n0 50# 5\n100 #\n\n# 7\n10 35 9 #", id="ASCII, comments among the numbers"),
        pytest.param(b"P2\n3 2\n255\n0 50 100 10 35 9 255", id="ASCII, one number more"),
        pytest.param(b"P3\n3 2\n255\n" + b" ".join(b"%d" % sample for sample in SAMPLES_THRICE), id="ASCII, colour"),
        pytest.param(b"P5\n3 2\n65535\n" + big_endian([0, 50 * 257, 100 * 257, 2570, 35 * 257, 2313]), id="16 bits"),
        pytest.param(b"P2\n3 2\n65535\n0 12850 25700 2570 8995 2313", id="16 bits, ASCII"),
        pytest.param(encoded(grey_image(GREYS), "PNG"), id="PNG"),
        pytest.param(encoded(grey_image(GREYS).convert("P"), "PNG"), id="PNG, palette"),
        pytest.param(encoded(Image.fromarray(np.array(GREYS, np.uint16) * 257), "PNG"), id="PNG, 16 bits"),
        pytest.param(encoded(grey_image(GREYS), "BMP"), id="BMP"),
        pytest.param(encoded(grey_image(GREYS).convert("RGB"), "BMP"), id="BMP, colour"),
        pytest.param(encoded(grey_image(GREYS), "TIFF"), id="TIFF"),
        pytest.param(encoded(grey_image(GREYS), "TIFF", compression="tiff_lzw"), id="TIFF, LZW"),
        pytest.param(encoded(Image.fromarray(np.array(GREYS, np.uint16) * 257), "TIFF"), id="TIFF, 16 bits"),
        pytest.param(encoded(grey_image(GREYS), "GIF"), id="GIF"),
    ],
)
def test_all_encodings_of_an_image_give_the_same_greys(tmp_path: Path, image: bytes) -> None:
    assert greys_of(tmp_path, image) == GREYS


@pytest.mark.parametrize("image_format", ["PPM", "PNG", "BMP", "TIFF", "GIF"])
def test_a_pgm_is_read_without_pillow_and_others_with_one_of_its_readers(tmp_path: Path, image_format: str) -> None:
    path = write_map(tmp_path, encoded(grey_image(GREYS), image_format), mode="raw")
    code = (
        "import sys; import mobile_robot_simulator as mrs\n"
        f"print(mrs.load_map({str(path)!r}).cells.tolist()[::-1])\n"
        f"print('PIL' in sys.modules, 'PIL.{image_format.capitalize()}ImagePlugin' in sys.modules)"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    with_pillow = image_format != "PPM"
    assert ran.stdout.splitlines() == [f"{GREYS}", f"{with_pillow} {with_pillow}"]


def test_palette_images_use_the_colours_not_the_indices(tmp_path: Path) -> None:
    image = grey_image([[0, 1, 2]])
    image.putpalette([90, 90, 90, 20, 20, 20, 255, 0, 0])
    assert greys_of(tmp_path, encoded(image, "PNG")) == [[90, 20, 76]]


def test_jpeg_is_read_approximately(tmp_path: Path) -> None:
    image = grey_image([[20] * 16, [60] * 16] * 8)
    greys = np.array(greys_of(tmp_path, encoded(image, "JPEG", quality=95)))
    assert np.abs(greys - np.asarray(image)).max() <= 2


def test_bitmaps_are_black_where_their_bits_are_set(tmp_path: Path) -> None:
    bits = [[1, 0, 1, 1, 0, 0, 0, 1, 0, 1], [0, 1, 0, 0, 0, 0, 0, 0, 1, 1]]
    cells = [[100 * bit for bit in row] for row in bits[::-1]]
    packed = bytes([0b10110001, 0b01000000, 0b01000000, 0b11111111])
    one_bit = Image.fromarray(np.array(bits, np.uint8) == 0)
    for image in (
        b"P4\n10 2\n" + packed,
        b"P1\n10 2\n" + b"1011000101" + b"0100000011",
        b"P1 # c\n10 2\n1 0 1 1 0 0 0 1 0 1 # 1 1\n0 1 0 0 0 0 0 0 1 1\n",
        encoded(one_bit, "PNG"),
        encoded(one_bit, "BMP"),
    ):
        assert cells_of(write_map(tmp_path, image)) == cells


def test_samples_are_scaled_to_8_bits_rounding_down(tmp_path: Path) -> None:
    assert greys_of(tmp_path, b"P5\n4 1\n100\n" + bytes([0, 1, 20, 39])) == [[0, 2, 51, 99]]  # 2.55, 51, 99.45
    assert greys_of(tmp_path, b"P5\n3 1\n1000\n" + big_endian([0, 100, 390])) == [[0, 25, 99]]  # 25.5, 99.45
    assert greys_of(tmp_path, b"P5\n3 1\n65535\n" + big_endian([256, 257, 25699])) == [[0, 1, 99]]
    sixteen_bits = Image.fromarray(np.array([[256, 257, 25699]], np.uint16))
    assert greys_of(tmp_path, encoded(sixteen_bits, "PNG")) == [[0, 1, 99]]


def test_rounding_down_matters_at_a_threshold(tmp_path: Path) -> None:
    # 90 of 100 is 229.5: grey 229 has p = 0.102, grey 230 would have 0.098.
    assert cells_of(write_map(tmp_path, b"P5\n1 1\n100\n" + bytes([90]), free_thresh="0.1")) == [[-1]]


def test_samples_above_the_largest_are_white(tmp_path: Path) -> None:
    assert cells_of(write_map(tmp_path, b"P5\n3 1\n100\n" + bytes([100, 101, 255]))) == [[0, 0, 0]]


# --- The YAML ---


@pytest.mark.parametrize("text", ["0.05", "0.05e0", "5e-2", ".05", "+0.050", '"0.05"', "0.05 # m"])
def test_numbers_may_be_written_in_many_ways(tmp_path: Path, text: str) -> None:
    assert mrs.load_map(write_map(tmp_path, pgm([[0]]), resolution=text)).resolution == 0.05


def test_entries_reach_the_grid(tmp_path: Path) -> None:
    grid = mrs.load_map(write_map(tmp_path, pgm([[0, 0, 0]])), occupied_threshold=70, unknown="occupied")
    assert grid.shape == (1, 3)
    assert grid.cells.dtype == np.int8
    assert tuple(grid.origin) == (-1.5, 2.0, 0.25)
    assert (grid.resolution, grid.occupied_threshold, grid.unknown) == (0.05, 70, "occupied")
    grid = mrs.load_map(str(tmp_path / "map.yaml"))
    assert (grid.occupied_threshold, grid.unknown) == (60, "free")


def test_unknown_entries_are_ignored(tmp_path: Path) -> None:
    assert cells_of(write_map(tmp_path, pgm([[0]]), floor="3", tags="[a, {b: 1}]")) == [[100]]


def test_image_is_relative_to_the_yaml_or_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "images").mkdir()
    (tmp_path / "elsewhere").mkdir()
    image = tmp_path / "images" / "a b.pgm"
    image.write_bytes(pgm([[0, 254]]))
    monkeypatch.chdir(tmp_path / "elsewhere")
    write_yaml(tmp_path, image="images/a b.pgm")
    assert cells_of(Path("../map.yaml")) == [[100, 0]]
    assert cells_of(write_yaml(tmp_path, image=str(image))) == [[100, 0]]


PLAIN = "image: map.pgm\nresolution: 0.05\norigin: [1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


@pytest.mark.parametrize(
    "text",
    [
        PLAIN.replace("0.05\n", "0.05\t\n"),
        PLAIN.replace("resolution: ", "resolution:\t"),
        PLAIN.replace("1.0, 2.0", "1.0,\t2.0"),
        PLAIN.replace("negate: 0", "negate: no"),
        PLAIN.replace("negate: 0", "negate: off"),
        PLAIN.replace("negate: 0", "negate: False"),
        PLAIN + "---\nimage: other.pgm\n",
        "%YAML:1.0\n" + PLAIN,
        PLAIN + "that is all\n",
        PLAIN.replace("\n", "\r\n"),
        "\ufeff" + PLAIN,
        PLAIN.replace("image: map.pgm", 'image: "map.pgm" # the map'),
    ],
    ids=[
        *("tab after a value", "tab after a colon", "tab in a list", "no", "off", "False", "second document", "OpenCV"),
        *("stray text", "Windows line ends", "byte order mark", "comment"),
    ],
)
def test_what_yaml_cpp_reads_is_read(tmp_path: Path, text: str) -> None:
    (tmp_path / "map.pgm").write_bytes(pgm([[0, 254]]))
    path = tmp_path / "map.yaml"
    path.write_text(text, newline="")
    grid = mrs.load_map(path)
    assert grid.cells.tolist() == [[100, 0]] and tuple(grid.origin) == (1.0, 2.0, 0.0)


@pytest.mark.parametrize("negate", ["yes", "on", "TRUE", "1"])
def test_words_for_true_negate_the_image(tmp_path: Path, negate: str) -> None:
    assert cells_of(write_map(tmp_path, pgm([[0, 254]]), negate=negate)) == [[0, 100]]


def test_comments_may_have_bytes_that_are_not_utf_8(tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(pgm([[0]]))
    path = tmp_path / "map.yaml"
    path.write_bytes(b"# carte \xe9tage\n" + PLAIN.encode())
    assert mrs.load_map(path).cells.tolist() == [[100]]


def test_an_image_in_the_home_folder_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "map.pgm").write_bytes(pgm([[0]]))
    assert cells_of(write_yaml(tmp_path, image="~/map.pgm")) == [[100]]


@pytest.mark.parametrize("image", ["/home/someone/maps/map.pgm", r"C:\\maps\\map.pgm", "maps/map.pgm"])
def test_the_error_names_an_image_that_lies_beside_the_yaml(tmp_path: Path, image: str) -> None:
    path = write_map(tmp_path, pgm([[0]]), image=f'"{image}"')
    with pytest.raises(FileNotFoundError, match=r"map\.pgm.*beside|beside.*map\.pgm"):
        mrs.load_map(path)


@pytest.mark.parametrize("special", ["map.yaml", "map.pgm"])
def test_special_files_are_refused_at_once(tmp_path: Path, special: str) -> None:
    path = write_map(tmp_path, pgm([[0]]))
    (tmp_path / special).unlink()
    os.mkfifo(tmp_path / special)
    with pytest.raises(OSError, match=r"[Mm]ust be a regular file, got a FIFO"):
        mrs.load_map(path)
    (tmp_path / special).unlink()
    (tmp_path / special).symlink_to("/dev/zero")
    with pytest.raises(OSError, match=r"[Mm]ust be a regular file, got a character device"):
        mrs.load_map(path)


def test_aliases_are_not_expanded_in_messages(tmp_path: Path) -> None:
    """Nine levels of nine references each stand for 387 million words."""
    levels = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    levels += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 9)]
    path = tmp_path / "map.yaml"
    path.write_text("\n".join([*levels, PLAIN.replace("[1.0, 2.0, 0.0]", "*a8")]))
    with pytest.raises(ValueError, match="origin must be three numbers") as caught:
        mrs.load_map(path)
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize("yaw", ["nan", "-nan", ".nan", "-NaN"])
def test_yaw_of_nan_is_zero_with_a_warning(tmp_path: Path, yaw: str) -> None:
    path = write_map(tmp_path, pgm([[0]]), origin=f"[1.0, 2.0, {yaw}]")
    with pytest.warns(UserWarning, match=rf"yaw of the map's origin is {yaw}; 0 is used instead") as caught:
        grid = mrs.load_map(path)
    assert tuple(grid.origin) == (1.0, 2.0, 0.0)
    assert caught[0].filename == __file__


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (
            {"image": None},
            "missing image; the required keys are image, resolution, origin, negate, occupied_thresh, free_thresh",
        ),
        ({"negate": None, "origin": None}, "missing origin, negate; the required keys are"),
        ({"image": ""}, "image must be the path of an image, got ''"),
        ({"image": "[map.pgm]"}, "image must be the path of an image, got '[map.pgm]' in line 1"),
        ({"resolution": "0"}, "resolution must be a positive number [m], got '0'"),
        ({"resolution": "-0.05"}, "resolution must be a positive number [m], got '-0.05'"),
        ({"resolution": "nan"}, "resolution must be a positive number [m], got 'nan'"),
        ({"resolution": "1e999"}, "resolution must be a positive number [m], got '1e999'"),
        ({"resolution": "5 cm"}, "resolution must be a positive number [m], got '5 cm'"),
        ({"resolution": "true"}, "resolution must be a positive number [m], got 'true'"),
        ({"resolution": ""}, "resolution must be a positive number [m], got ''"),
        ({"resolution": "[0.05]"}, "resolution must be a positive number [m], got '[0.05]' in line 2"),
        ({"resolution": "2024-13-45"}, "resolution must be a positive number [m], got '2024-13-45'"),
        ({"origin": "[0, 0]"}, "origin must be three numbers [x, y, yaw], got '[0, 0]' in line 3"),
        ({"origin": "[0, 0, 0, 0]"}, "origin must be three numbers [x, y, yaw], got '[0, 0, 0, 0]' in line 3"),
        ({"origin": "0"}, "origin must be three numbers [x, y, yaw], got '0'"),
        ({"origin": "[0, west, 0]"}, "origin must be three finite numbers [x, y, yaw], got '[0, west, 0]' in line 3"),
        ({"origin": "[nan, 0, 0]"}, "origin must be three finite numbers [x, y, yaw], got '[nan, 0, 0]' in line 3"),
        ({"origin": "[0, 0, .inf]"}, "origin must be three finite numbers [x, y, yaw], got '[0, 0, .inf]' in line 3"),
        ({"origin": "[0, 0, [1]]"}, "origin must be three finite numbers [x, y, yaw], got '[0, 0, [1]]' in line 3"),
        ({"negate": "0.5"}, "negate must be 0, 1, no, yes, off, on, false or true, got '0.5' in line 4"),
        ({"negate": "maybe"}, "negate must be 0, 1, no, yes, off, on, false or true, got 'maybe' in line 4"),
        ({"occupied_thresh": "65"}, "occupied_thresh must be a number from 0 to 1, got '65'"),
        ({"occupied_thresh": "high"}, "occupied_thresh must be a number from 0 to 1, got 'high'"),
        ({"free_thresh": "-0.1"}, "free_thresh must be a number from 0 to 1, got '-0.1'"),
        ({"free_thresh": "nan"}, "free_thresh must be a number from 0 to 1, got 'nan'"),
        ({"free_thresh": "0.7"}, "free_thresh must be at most occupied_thresh, which is 0.65, got '0.7'"),
        ({"mode": "Trinary"}, "mode must be trinary, scale or raw, got 'Trinary'"),
        ({"mode": "[raw]"}, "mode must be trinary, scale or raw, got '[raw]' in line 7"),
    ],
)
def test_invalid_entries_are_rejected(tmp_path: Path, entries: dict[str, str | None], message: str) -> None:
    path = write_map(tmp_path, pgm([[0]]), **entries)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value).startswith(f"{path}: {message}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "must contain a YAML mapping, got ''"),
        (b"map.pgm", "must contain a YAML mapping, got 'map.pgm'"),
        (b"- image\n", "must contain a YAML mapping, got"),
        (b"image: [", "not valid YAML: "),
        (b"image: a\nimage: b\n", "line 2: 'image' must be given once, got it in line 1 too"),
        (b"\x89PNG\r\n\x1a\n\0\0", "this is an image; give the YAML file of the map"),
        (b"P5\n3 2\n255\n", "this is an image; give the YAML file of the map"),
        (b"[" * 3000, "not valid YAML: "),
    ],
)
def test_text_that_is_not_a_yaml_mapping_is_rejected(tmp_path: Path, text: bytes, message: str) -> None:
    path = tmp_path / "map.yaml"
    path.write_bytes(text)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value).startswith(f"{path}: {message}")


def test_a_missing_yaml_and_a_folder_are_os_errors(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.yaml"):
        mrs.load_map(tmp_path / "nowhere.yaml")
    with pytest.raises(IsADirectoryError):
        mrs.load_map(tmp_path)


# --- Invalid images ---


def test_the_error_for_a_missing_image_names_the_image_and_the_map(tmp_path: Path) -> None:
    path = write_yaml(tmp_path)
    with pytest.raises(FileNotFoundError) as caught:
        mrs.load_map(path)
    assert f"image of the map {path}" in str(caught.value)
    assert caught.value.filename == str(tmp_path / "map.pgm")
    (tmp_path / "map.pgm").mkdir()
    with pytest.raises(IsADirectoryError, match=r"image of the map .*map\.yaml"):
        mrs.load_map(path)


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (b"", "the file is empty"),
        (b"%PDF-1.7", "must be a PNM, PNG, JPEG, BMP, TIFF or GIF image, got a file that starts with b'%PDF-1.7'"),
        (b"P7\nWIDTH 1\n", "must be a PNM, PNG, JPEG"),
        (b"P5", "the PNM header is invalid: b'P5'"),
        (b"P5\n3 two\n255\n", "the PNM header is invalid"),
        (b"P5\n3 2\n255", "the PNM header is invalid"),
        (b"P5\n-3 2\n255\n", "the PNM header is invalid"),
        (b"P5\n0 2\n255\n", "an image must have from 1 to 1073741824 pixels, got 0 x 2"),
        (b"P5\n40000 40000\n255\n", "an image must have from 1 to 1073741824 pixels, got 40000 x 40000"),
        (b"P5\n3 2\n0\n" + SAMPLES, "the largest sample of a PNM image must be from 1 to 65535, got 0"),
        (b"P5\n3 2\n65536\n" + 2 * SAMPLES, "the largest sample of a PNM image must be from 1 to 65535, got 65536"),
        (b"P5\n3 2\n255\n" + SAMPLES[:5], "the file is truncated: 5 of 6 samples"),
        (b"P5\n3 2\n256\n" + SAMPLES + SAMPLES[:5], "the file is truncated: 5 of 6 samples"),
        (b"P6\n3 2\n255\n" + 2 * SAMPLES, "the file is truncated: 12 of 18 samples"),
        (b"P4\n9 2\n" + bytes(3), "the file is truncated: 3 of 4 samples"),
        (b"P5\n3 2\n255\n", "the file is truncated: 0 of 6 samples"),
        (b"P4\n9 2\n", "the file is truncated: 0 of 4 samples"),
        (b"P1\n3 2\n1 0 1 0 1", "the file is truncated: 5 of 6 samples"),
        (b"P1\n3 2\n1 0 2 0 1 0", "ASCII samples must be numbers, got b'2'"),
        (b"P2\n3 2\n255\n1 2 3 4 5 # 6", "the file is truncated: 5 of 6 samples"),
        (b"P2\n1 1\n255\n \n", "the file is truncated: 0 of 1 samples"),
        (b"P2\n3 2\n255\n1 2 three 4 5 6", "ASCII samples must be numbers, got b'three'"),
        (b"P2\n3 2\n255\n1 2 -3 4 5 6", "ASCII samples must be numbers, got b'-'"),
        (b"P2\n3 2\n255\n1 2 3 4 5 256", "samples must be at most 255, got 256"),
        (b"P2\n1 1\n255\n99999999999999999999", "samples must be at most 255, got"),
        (encoded(Image.new("F", (1, 1)), "TIFF"), "samples must have at most 16 bits, got 32"),
    ],
)
def test_corrupt_images_are_rejected(tmp_path: Path, image: bytes, message: str) -> None:
    path = write_map(tmp_path, image)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value).startswith(f"{tmp_path / 'map.pgm'}: cannot read the image of the map {path}: {message}")


NOISE = Image.fromarray(np.random.default_rng(11).integers(0, 256, (40, 30), np.uint8))


@pytest.mark.parametrize("tolerant", [False, True])
@pytest.mark.parametrize(
    "image",
    [
        pytest.param(encoded(NOISE, "PPM"), id="PGM"),
        pytest.param(encoded(NOISE, "PNG"), id="PNG"),
        pytest.param(encoded(NOISE.convert("RGBA"), "PNG"), id="PNG, alpha"),
        pytest.param(encoded(NOISE, "JPEG"), id="JPEG"),
        pytest.param(encoded(NOISE, "JPEG", progressive=True), id="JPEG, progressive"),
        pytest.param(encoded(NOISE, "BMP"), id="BMP"),
        pytest.param(encoded(NOISE, "TIFF"), id="TIFF"),
        pytest.param(encoded(NOISE, "TIFF", compression="tiff_lzw"), id="TIFF, LZW"),
        pytest.param(encoded(NOISE, "GIF"), id="GIF"),
    ],
)
def test_truncated_images_are_rejected_regardless_of_pillow_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, image: bytes, tolerant: bool
) -> None:
    whole = cells_of(write_map(tmp_path, image))
    monkeypatch.setattr(ImageFile, "LOAD_TRUNCATED_IMAGES", tolerant)
    assert cells_of(write_map(tmp_path, image)) == whole
    for kept in (1, len(image) // 3, len(image) // 2, len(image) - len(image) // 10):
        path = write_map(tmp_path, image[:kept])
        with pytest.raises(ValueError, match=r"map\.pgm: cannot read the image of the map"):
            mrs.load_map(path)


@pytest.mark.parametrize("tolerant", [False, True])
def test_a_png_with_a_flipped_bit_is_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tolerant: bool) -> None:
    monkeypatch.setattr(ImageFile, "LOAD_TRUNCATED_IMAGES", tolerant)
    image = bytearray(encoded(NOISE, "PNG"))
    image[len(image) // 2] ^= 1
    path = write_map(tmp_path, bytes(image))
    with pytest.raises(ValueError, match="checksum"):
        mrs.load_map(path)


def test_the_pixel_limit_of_pillow_is_neither_used_nor_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 3)
    path = write_map(tmp_path, encoded(NOISE, "PNG"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert mrs.load_map(path).shape == (40, 30)
    assert Image.MAX_IMAGE_PIXELS == 3


def test_a_header_with_too_many_pixels_is_rejected(tmp_path: Path) -> None:
    header = b"IHDR" + struct.pack(">IIBBBBB", 50000, 50000, 8, 0, 0, 0, 0)
    chunks = [header, b"IDAT" + zlib.compress(b"\0"), b"IEND"]
    png = b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(chunk) - 4) + chunk + struct.pack(">I", zlib.crc32(chunk)) for chunk in chunks
    )
    path = write_map(tmp_path, png)
    with pytest.raises(ValueError, match="from 1 to 268435456 pixels, got 50000 x 50000"):
        mrs.load_map(path)


# --- Saving ---


def assert_same(left: mrs.OccupancyGrid, right: mrs.OccupancyGrid) -> None:
    assert left.cells.dtype == right.cells.dtype
    np.testing.assert_array_equal(left.cells, right.cells)
    assert left.resolution == right.resolution
    assert tuple(left.origin) == tuple(right.origin)


finite = st.floats(-1e6, 1e6)


@settings(derandomize=True, database=None, deadline=None, max_examples=150)
@given(
    shape=st.tuples(st.integers(1, 5), st.integers(1, 5)),
    values=st.sampled_from([(-1, 0, 100), (-1, 101)]),
    seed=st.integers(0, 1000),
    resolution=st.floats(1e-3, 1e3),
    origin=st.tuples(finite, finite, st.floats(-3.141592653589793, 3.141592653589793)),
)
def test_a_saved_map_loads_unchanged(
    shape: tuple[int, int],
    values: tuple[int, ...],
    seed: int,
    resolution: float,
    origin: tuple[float, float, float],
) -> None:
    random = np.random.default_rng(seed)
    cells = (random.integers(*values, shape) if len(values) == 2 else random.choice(values, shape)).astype(np.int8)
    grid = mrs.OccupancyGrid(cells, resolution=resolution, origin=origin)
    with tempfile.TemporaryDirectory() as folder:
        mrs.save_map(grid, Path(folder) / "copy.yaml")
        assert_same(mrs.load_map(Path(folder) / "copy.yaml"), grid)


@pytest.mark.parametrize(
    ("values", "mode"), [(range(-1, 101), "raw"), ((-1, 0, 100), "trinary"), ((0,), "trinary"), ((-1, 99), "raw")]
)
def test_saved_files_have_the_format_of_map_servers(tmp_path: Path, values: list[int], mode: str) -> None:
    grid = mrs.OccupancyGrid(np.array([list(values)], np.int8), resolution=1e-5, origin=(0.1, -2.0, 1e-17))
    mrs.save_map(grid, str(tmp_path / "a copy.v2.yaml"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a copy.v2.pgm", "a copy.v2.yaml"]
    assert yaml.safe_load((tmp_path / "a copy.v2.yaml").read_text()) == {
        "image": "a copy.v2.pgm",
        "mode": mode,
        "resolution": 1e-5,
        "origin": [0.1, -2.0, 1e-17],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    assert_same(mrs.load_map(tmp_path / "a copy.v2.yaml"), grid)


def test_saved_greys_equal_those_of_map_saver_bottom_row_last(tmp_path: Path) -> None:
    mrs.save_map(mrs.OccupancyGrid(np.array([[-1, 0], [100, 0]], np.int8), resolution=1.0), tmp_path / "map.yml")
    assert (tmp_path / "map.pgm").read_bytes() == b"P5\n2 2\n255\n" + bytes([0, 254, 205, 254])


def save_one_cell(folder: Path, value: int) -> dict[str, bytes]:
    """Saves a map of one cell in a folder and returns the contents of all files there by name."""
    mrs.save_map(mrs.OccupancyGrid(np.array([[value]], np.int8), resolution=1.0), folder / "map.yaml")
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_saving_replaces_an_older_map(tmp_path: Path) -> None:
    save_one_cell(tmp_path, 100)
    assert set(save_one_cell(tmp_path, 7)) == {"map.pgm", "map.yaml"}
    assert cells_of(tmp_path / "map.yaml") == [[7]]


def test_the_image_is_replaced_before_the_yaml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    replaced = []
    replace = os.replace

    def noting(source: Path, target: Path) -> None:
        replaced.append(Path(target).name)
        replace(source, target)

    monkeypatch.setattr(os, "replace", noting)
    save_one_cell(tmp_path, 0)
    assert replaced == ["map.pgm", "map.yaml"]


def test_invalid_paths_are_rejected(tmp_path: Path) -> None:
    grid = mrs.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0)
    with pytest.raises(ValueError, match=r"path of a map must end in \.yaml or \.yml, got '.*map\.pgm'"):
        mrs.save_map(grid, tmp_path / "map.pgm")
    with pytest.raises(FileNotFoundError, match=r"no such folder: '.*nowhere'"):
        mrs.save_map(grid, tmp_path / "nowhere" / "map.yaml")
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(IsADirectoryError, match=r"over a folder: '.*folder\.yaml'"):
        mrs.save_map(grid, tmp_path / "folder.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["folder.yaml"]


# --- Images as GraphicsMagick reads them ---

ENCODED = json.loads((CARRIED_MAPS / "encodings" / "graphicsmagick.json").read_text())
"""8-bit greys that GraphicsMagick reads from each image, top row first."""

TRANSPARENT = {"png_la.png", "png_rgba_transparent.png"}  # at (row, column) (0, 0), (1, 0) and (2, 3)


def expected_cell(mode: str, grey: int, opaque: bool) -> int:
    """Reference for the cell value of one pixel, with thresholds 0.65 and 0.196."""
    if mode == "raw":
        return grey if grey <= 100 else -1
    if not opaque:
        return -1
    occupancy = (255 - grey) / 255
    if occupancy >= 0.65:
        return 100
    if occupancy <= 0.196:
        return 0
    return -1 if mode == "trinary" else round((occupancy - 0.196) / (0.65 - 0.196) * 100)


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
@pytest.mark.parametrize("name", ENCODED)
def test_all_encodings_load_as_graphicsmagick_reads_them(tmp_path: Path, name: str, mode: str) -> None:
    greys = np.array(ENCODED[name])
    clear = [(0, 0), (1, 0), (2, 3)] if name in TRANSPARENT else []
    expected = [[expected_cell(mode, int(greys[row, col]), (row, col) not in clear) for col in range(6)] for row in range(4)]
    shutil.copy(CARRIED_MAPS / "encodings" / name, tmp_path / name)
    cells = mrs.load_map(write_yaml(tmp_path, image=name, mode=mode)).cells
    if name == "jpg_l.jpg" and mode == "raw":  # JPEG decoders may differ by one level
        assert np.abs(cells - np.array(expected[::-1])).max() <= 1
    else:
        assert cells.tolist() == expected[::-1]


def test_the_truncated_encoding_is_rejected_and_every_file_has_a_test(tmp_path: Path) -> None:
    folder = CARRIED_MAPS / "encodings"
    assert {path.name for path in folder.iterdir()} == {*ENCODED, "p5_truncated.pgm", "graphicsmagick.json"}
    path = write_yaml(tmp_path, image=str(folder.resolve() / "p5_truncated.pgm"))
    with pytest.raises(ValueError, match=r"p5_truncated\.pgm: .*the file is truncated: 19 of 24 samples"):
        mrs.load_map(path)


# --- Whole maps ---

CARRIED: Expected = {
    "cave_turned": ((240, 320), 0.05054, (-22.1918, -24.3587, -0.221075), (29142, 37758, 9900)),
    "corridor_shades": ((100, 600), 0.1, (0.0, 0.0, 0.0), (22574, 29668, 7758)),
    "maze_negated": ((53, 60), 0.15, (-2.0, -3.0, -1.0), (0, 2322, 858)),
    "maze_one_line_header": ((53, 60), 0.15, (0.0, 0.0, 0.0), (0, 2322, 858)),
    "office": ((240, 320), 0.05, (-10.0, -8.0, 0.0), (0, 63482, 13318)),
    "office_turned": ((240, 320), 0.0504, (25.9, 48.5, 3.14), (0, 63482, 13318)),
    "warehouse_grey_is_free": ((240, 320), 0.05, (0.0, 0.0, 0.0), (0, 66840, 9960)),
}

# Values as in `summary`, counted in the pixels that GraphicsMagick reads.
REAL: Expected = {
    "f1_berlin/map.yaml": ((600, 600), 0.05, (-11.60654, -26.520793, 0.0), (0, 107954, 252046)),
    "flatland_conestogo/map.yaml": ((505, 1310), 0.05, (-16.6, -6.65, 0.0), (147748, 495587, 18215)),
    "mit_basement_fixed/map.yaml": ((1300, 1300), 0.0504, (25.9, 48.5, 3.14), (1399884, 275742, 14374)),
    "mrpt_yaml_32/map.yaml": ((66, 30), 0.15, (-4.5, 0.0, 0.0), (0, 1737, 243)),
    "nav2_depot/map.yaml": ((307, 604), 0.05, (0.0, 0.0, 0.0), (0, 179481, 5947)),
    "nav2_tb3_sandbox/map.yaml": ((384, 384), 0.05, (-10.0, -10.0, 0.0), (138683, 7903, 870)),
    "nav2_warehouse/map.yaml": ((1674, 1006), 0.03, (-15.1, -25.0, 0.0), (230801, 1422292, 30951)),
    "radish_intel/map.yaml": ((848, 888), 0.05, (0.0, 0.0, 0.0), (527189, 212980, 12855)),
    "radish_intel/map_logframe.yaml": (
        (848, 888),
        0.05054,
        (-22.1918, -24.3587, -0.221075),
        (527189, 212980, 12855),
    ),
    "rl_basement_hallways_5cm/map.yaml": ((1200, 1200), 0.05, (0.0, 0.0, 0.0), (1195598, 233220, 11182)),
    "rl_huge/map.yaml": ((10976, 4128), 0.05, (0.0, 0.0, 0.0), (28112992, 16743232, 452704)),
    "ros1_testmap2_negate/map.yaml": ((12, 12), 0.1, (-2.0, -3.0, -1.0), (0, 88, 56)),
    "tb3_world/map.yaml": ((384, 384), 0.05, (-10.0, -10.0, 0.0), (138722, 7939, 795)),
    "willow_2010_0.10/map.yaml": ((608, 566), 0.1, (0.0, 0.0, 0.0), (234377, 109207, 544)),
}


def summary(path: Path) -> tuple[Any, ...]:
    """Shape, resolution and origin of a map, and its numbers of unknown, free and occupied cells."""
    grid = mrs.load_map(path)
    counts = tuple(int(np.count_nonzero(grid.cells == value)) for value in (-1, 0, 100))
    return grid.shape, grid.resolution, tuple(grid.origin), counts


@pytest.mark.parametrize("name", CARRIED)
def test_carried_maps_load(name: str) -> None:
    assert summary(CARRIED_MAPS / name / "map.yaml") == CARRIED[name]


def test_every_carried_map_has_a_test() -> None:
    assert {path.parent.name for path in CARRIED_MAPS.glob("*/map.yaml")} == set(CARRIED)


@needs_real_maps
@pytest.mark.parametrize("name", REAL)
def test_real_maps_load(name: str) -> None:
    assert summary(SHARED_MAPS / name) == REAL[name]


@needs_real_maps
def test_every_real_map_has_a_test() -> None:
    assert {str(path.relative_to(SHARED_MAPS)) for path in SHARED_MAPS.glob("*/*.yaml")} == set(REAL)


@pytest.mark.parametrize("path", maps(carried=["office"], real=["nav2_depot/map.yaml"]))
def test_a_map_stands_upright(path: Path) -> None:
    with Image.open(path.parent / yaml.safe_load(path.read_text())["image"]) as image:
        black = np.argwhere(np.asarray(image)[::-1] == 0)
    occupied = np.argwhere(mrs.load_map(path).cells == 100)
    assert len(black)
    assert {tuple(cell) for cell in black.tolist()} <= {tuple(cell) for cell in occupied.tolist()}
