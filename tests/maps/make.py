"""Generates the maps in this folder: `python tests/maps/make.py`. Needs GraphicsMagick (`gm`) on the path.

`encodings/` holds one image of 6 x 4 pixels in each encoding that map files use. `graphicsmagick.json` there holds the
8-bit greys that GraphicsMagick reads from each image; the map server of Nav2 reads maps with GraphicsMagick. The other
folders hold generated floor plans. Each has a feature of real maps that a map reader or a ray caster can get wrong.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import mobile_robot_simulator as mrs

HERE = Path(__file__).parent

GREYS = np.array(
    [
        [0, 254, 205, 255, 89, 90],
        [100, 50, 230, 229, 60, 0],
        [205, 206, 204, 0, 254, 128],
        [255, 255, 0, 1, 2, 3],
    ],
    np.uint8,
)
"""Greys at and near the thresholds of map servers: 205 is unknown, 89 and 90 are close to 0.65, 206 is below 0.196."""


def encodings() -> dict[str, bytes | tuple[Image.Image, dict[str, Any]]]:
    """Returns the content of each file by name: its bytes, or an image and the options with which Pillow saves it."""
    plain = GREYS.tobytes()
    text = " ".join(map(str, GREYS.ravel()))
    wide = GREYS.astype(np.uint32)
    bits = GREYS >= 128
    grey = Image.fromarray(GREYS)
    alpha = np.full_like(GREYS, 255)
    alpha[0, 0], alpha[1, 0], alpha[2, 3] = 0, 128, 254
    colour = np.full((4, 6, 3), 255, np.uint8)
    colour[0, :4] = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)
    colour[1, :2] = (0, 0, 0), (200, 100, 50)
    reversed_palette = Image.fromarray(255 - GREYS)
    reversed_palette.putpalette([value for value in range(255, -1, -1) for _ in range(3)])
    return {
        "bmp_24bit.bmp": (grey.convert("RGB"), {}),
        "bmp_8bit.bmp": (grey, {}),
        "jpg_l.jpg": (grey, {"quality": 95}),
        "p2_ascii.pgm": f"P2\n# text\n6 4\n255\n{text}\n".encode(),
        "p2_ascii_oneperline.pgm": f"P2\n6 4\n255\n{text}\n".replace(" ", "\n").replace("6\n4", "6 4").encode(),
        "p4_bitmap.pbm": b"P4\n6 4\n" + np.packbits(~bits, axis=1).tobytes(),
        "p5_12bit_maxval4095.pgm": b"P5\n6 4\n4095\n" + (wide * 4095 // 255).astype(">u2").tobytes(),
        "p5_16bit.pgm": b"P5\n6 4\n65535\n" + (wide * 257).astype(">u2").tobytes(),
        "p5_comments_everywhere.pgm": b"P5 # type\n# from a map saver, 0.05 m/pix\n6 # width\n#\n4\n# depth\n255\n" + plain,
        "p5_crlf_header.pgm": b"P5\r\n6 4\r\n255\n" + plain,
        "p5_maxval100.pgm": b"P5\n6 4\n100\n" + (wide * 100 // 255).astype(np.uint8).tobytes(),
        "p5_oneline_header.pgm": b"P5 6  4 \t255\n" + plain,
        "p5_plain.pgm": b"P5\n6 4\n255\n" + plain,
        "p5_trailing_bytes.pgm": b"P5\n6 4\n255\n" + plain + b"\n\n",
        "p6_rgb.ppm": b"P6\n6 4\n255\n" + GREYS.repeat(3).tobytes(),
        "png_16bit.png": (Image.fromarray((wide * 257).astype(np.uint16)), {}),
        "png_1bit.png": (Image.fromarray(bits), {}),
        "png_colour.png": (Image.fromarray(colour), {}),
        "png_l.png": (grey, {}),
        "png_la.png": (Image.fromarray(np.dstack([GREYS, alpha]), "LA"), {}),
        "png_palette_adaptive.png": (grey.convert("RGB").convert("P", palette=Image.Palette.ADAPTIVE), {}),
        "png_palette_reversed.png": (reversed_palette, {}),
        "png_rgb.png": (grey.convert("RGB"), {}),
        "png_rgba_transparent.png": (Image.fromarray(np.dstack([GREYS, GREYS, GREYS, alpha]), "RGBA"), {}),
        "tif_l.tif": (grey, {}),
    }


def make_encodings(folder: Path) -> None:
    """Writes the images, one truncated image, and the greys that GraphicsMagick reads."""
    folder.mkdir(exist_ok=True)
    read = {}
    for name, content in encodings().items():
        if isinstance(content, bytes):
            (folder / name).write_bytes(content)
        else:
            content[0].save(folder / name, **content[1])
        convert = ["gm", "convert", folder / name, "+matte", "-depth", "8", "gray:-"]
        done = subprocess.run(convert, capture_output=True, check=True)
        read[name] = np.frombuffer(done.stdout, np.uint8).reshape(4, 6).tolist()
    (folder / "p5_truncated.pgm").write_bytes(b"P5\n6 4\n255\n" + GREYS.tobytes()[:19])
    lines = ",\n".join(f" {json.dumps(name)}: {json.dumps(rows)}" for name, rows in read.items())
    (folder / "graphicsmagick.json").write_text(f"{{\n{lines}\n}}\n")


def make_map(
    name: str, grid: mrs.OccupancyGrid, *, shades: bool = False, header: bytes | None = None, **entries: Any
) -> None:
    """Writes a floor plan as a map.

    Args:
        name: Folder of the map.
        grid: The floor plan.
        shades: True to draw free and occupied cells in several greys.
        header: Header of a PGM file, with two %d for width and height. If None, a PNG file is written.
        **entries: Entries of the YAML file that differ from the defaults.
    """
    folder = HERE / name
    folder.mkdir(exist_ok=True)
    values = {
        "resolution": grid.resolution,
        "origin": [0.0, 0.0, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    values.update(entries)
    pixels = greys_of(grid.cells, shades=shades)
    pixels = 255 - pixels if values["negate"] else pixels
    image = "map.png" if header is None else "map.pgm"
    if header is None:
        Image.fromarray(pixels).save(folder / image, optimize=True)
    else:
        height, width = pixels.shape
        (folder / image).write_bytes(header % (width, height) + pixels.tobytes())
    text = "".join(f"{key}: {value}\n" for key, value in {"image": image, **values}.items())
    (folder / "map.yaml").write_text(text)


def greys_of(cells: NDArray[np.int8], *, shades: bool) -> NDArray[np.uint8]:
    """Returns the pixels of cells, top row first: 254 is free, 0 occupied, 205 unknown. `shades` varies the first two."""
    draw = np.random.default_rng(0).integers(0, 40, cells.shape) if shades else np.zeros(cells.shape, int)
    greys = np.select([cells == 100, cells == 0], [draw, 254 - draw // 4], 205)
    return greys[::-1].astype(np.uint8)


def make_maps() -> None:
    """Writes all floor plans."""
    office, warehouse, cave = (mrs.floor_plan(kind, seed=1, size=(16.0, 12.0)) for kind in ("office", "warehouse", "cave"))
    corridor = mrs.floor_plan("corridor", seed=1, size=(60.0, 10.0), resolution=0.1)
    maze = mrs.floor_plan("maze", seed=1, size=(9.0, 8.0), resolution=0.15)
    make_map("office", office, origin=[-10.0, -8.0, 0.0])
    make_map("office_turned", office, resolution=0.0504, origin=[25.9, 48.5, 3.14])
    make_map("warehouse_grey_is_free", warehouse, mode="trinary", free_thresh=0.25)
    make_map("corridor_shades", corridor, shades=True)
    make_map("cave_turned", cave, resolution=0.05054, origin=[-22.1918, -24.3587, -0.221075])
    make_map("maze_negated", maze, negate=1, occupied_thresh=0.5, free_thresh=0.2, origin=[-2.0, -3.0, -1.0])
    make_map("maze_one_line_header", maze, header=b"P5 %d %d 255\n", occupied_thresh=0.5, free_thresh=0.5)


if __name__ == "__main__":
    make_encodings(HERE / "encodings")
    make_maps()
