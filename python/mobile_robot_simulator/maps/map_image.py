"""Images of maps: reads an image file as 8-bit grey and alpha.

The pixels equal those of GraphicsMagick, which Nav2 uses to read maps. Only colours of 16-bit samples can come out one level
too high. Pillow is imported for the images that need it: most maps are PGM files, which do not.
"""

from __future__ import annotations

import io
import os
import re
from importlib import import_module
from pathlib import Path, PureWindowsPath
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..quoting import shortened
from ..user_files import open_regular, read_bytes

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageFile import ImageFile

_Grey = NDArray[np.uint8]
_Sample = TypeVar("_Sample", bound=np.generic)

# 32768 x 32768 pixels: 1.6 km by 1.6 km at 5 cm per pixel. A larger size is treated as a corrupt or malicious header.
_MAX_PIXELS = 2**30

# A compressed file of 1 MB can hold that many pixels, which then need several GB. 16384 x 16384 pixels need one.
_MAX_COMPRESSED_PIXELS = 2**28

# More than the largest image needs in any of the formats, except for colours of 16 bits.
_MAX_BYTES = 2**32

# GraphicsMagick's PixelIntensityRec601, (306 R + 601 G + 117 B) // 1024.
# The last number cancels the 0.5 that Pillow adds before it truncates.
_LUMA = (306 / 1024, 601 / 1024, 117 / 1024, -0.5)

# The format, as Pillow names its readers, is chosen by the file signature. Image.open is not used, because real maps can
# exceed its pixel limit. The limit is a global setting, which this package must not change.
_PILLOW_FORMATS: tuple[tuple[bytes, str], ...] = (
    (b"\x89PNG\r\n\x1a\n", "Png"),
    (b"\xff\xd8\xff", "Jpeg"),
    (b"BM", "Bmp"),
    (b"II*\0", "Tiff"),
    (b"MM\0*", "Tiff"),
    (b"GIF8", "Gif"),
)

_PNM_KINDS = (b"P1", b"P2", b"P3", b"P4", b"P5", b"P6")

# Netpbm headers: white space or comments separate the fields; one white space, or the end of a comment, ends the header.
_GAP = rb"(?:\s|#[^\r\n]*[\r\n])"
_WHITE_SPACE = b" \t\n\v\f\r"
_BITMAP_HEADER = re.compile(rb"P[14]" + 2 * (_GAP + rb"+(\d{1,9})") + _GAP)
_SAMPLES_HEADER = re.compile(rb"P[2356]" + 3 * (_GAP + rb"+(\d{1,9})") + _GAP)


class MapImage(NamedTuple):
    """An image of a map, (H, W) uint8, top row first."""

    grey: _Grey
    alpha: _Grey | None
    """255 is opaque; None if every pixel is opaque."""


def read_image(path: Path, yaml_path: Path) -> MapImage:
    """Reads the image of a map.

    Args:
        path: The image.
        yaml_path: The YAML file that names the image, for error messages.

    Raises:
        OSError: The image cannot be read. The message names both files.
        ValueError: The file is not an image, or it is truncated.
    """
    try:
        data = read_bytes(path, _MAX_BYTES)
    except OSError as error:
        raise OSError(
            error.errno, f"{error.strerror} (image of the map {yaml_path}){_place(path, yaml_path)}", str(path)
        ) from None
    try:
        if data[:2] in _PNM_KINDS:
            return _decode_pnm(data)
        return _decode_with_pillow(data)
    except MemoryError:
        raise
    except Exception as error:  # Pillow raises many kinds of errors for corrupt files.
        raise ValueError(f"{path}: cannot read the image of the map {yaml_path}: {shortened(error)}") from error


def is_image(path: Path) -> bool:
    """Returns True if a file starts like an image that `read_image` knows."""
    with open_regular(path) as file:
        start = file.read(8)
    return start[:2] in _PNM_KINDS or any(start.startswith(signature) for signature, _ in _PILLOW_FORMATS)


def _place(path: Path, yaml_path: Path) -> str:
    """Returns a hint where a missing image is: beside its YAML file, if that was written on another machine."""
    name = PureWindowsPath(path).name  # knows both separators
    beside = yaml_path.parent / name
    if os.path.lexists(path) or not beside.is_file():
        return ""
    return f"; a file of this name is beside the YAML file: write `image: {name}` there"


def _decode_with_pillow(data: bytes) -> MapImage:
    image = _open_with_pillow(data)
    _check_size(*image.size, _MAX_PIXELS if image.format == "BMP" else _MAX_COMPRESSED_PIXELS)
    if image.mode.startswith("I;16"):
        alpha = _mask_of_transparent_grey(image)
        return MapImage(_to_8_bits(np.asarray(image), 65535), alpha)
    if image.mode in ("I", "F"):
        raise ValueError(f"samples must have at most 16 bits, got 32 (Pillow mode {image.mode})")
    if not image.has_transparency_data:
        return MapImage(_luma(image), None)
    rgba = image.convert("RGBA")
    return MapImage(_luma(rgba), np.asarray(rgba.getchannel("A")))


def _open_with_pillow(data: bytes) -> ImageFile:
    if not data:
        raise ValueError("the file is empty")
    for signature, format in _PILLOW_FORMATS:
        if data.startswith(signature):
            reader: type[ImageFile] = getattr(import_module(f"PIL.{format}ImagePlugin"), f"{format}ImageFile")
            image = reader(_WholeFile(data))
            if format == "Png":
                # verify() compares the checksums, which reading does not. A verified image cannot be read, so open it again.
                image.verify()
                image = reader(_WholeFile(data))
            return image
    raise ValueError(f"must be a PNM, PNG, JPEG, BMP, TIFF or GIF image, got a file that starts with {data[:8]!r}")


class _WholeFile(io.BytesIO):
    """A file in memory that raises an error when it is read past its end.

    Many programs set ImageFile.LOAD_TRUNCATED_IMAGES. Pillow then fills the missing part of a truncated image with black.
    A truncated map must be an error regardless of that global setting.
    """

    def read(self, size: int | None = -1, /) -> bytes:
        data = super().read(size)
        if not data and size != 0:
            raise EOFError("the file is truncated")
        return data


def _luma(image: Image) -> _Grey:
    """Rec. 601 luma (H, W) uint8, computed as in GraphicsMagick."""
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L"))
    colours = image if image.mode == "RGB" else image.convert("RGB")
    return np.asarray(colours.convert("L", _LUMA))


def _mask_of_transparent_grey(image: ImageFile) -> _Grey | None:
    """Alpha of a 16-bit PNG with one transparent grey. Pillow's `convert` supports this for 8 bits only."""
    transparent = image.info.get("transparency")
    if transparent is None:
        return None
    return np.where(np.asarray(image) == transparent, 0, 255).astype(np.uint8)


def _to_8_bits(samples: NDArray[np.unsignedinteger], largest: int) -> _Grey:
    """Scales samples from 0..largest to 8 bits; samples above `largest` count as `largest`.

    As in GraphicsMagick, samples are first rounded to the nearest 16-bit level and then rounded down to 8 bits.
    """
    if largest == 255:
        return samples.astype(np.uint8, copy=False)
    levels = np.minimum(np.arange(np.iinfo(samples.dtype).max + 1), largest)
    table = ((levels * 65535 + largest // 2) // largest // 257).astype(np.uint8)
    greys: _Grey = table[samples]
    return greys


# --- Netpbm ---
#
# Most maps are PGM files. Pillow is not used for them, because it
# - rounds to the nearest level if the largest sample is not 255, while GraphicsMagick rounds down. With a free_thresh of
#   0.1, a sample that scales to 229.5 would become free instead of unknown;
# - decodes such files and ASCII files one number at a time in Python;
# - joins two ASCII numbers if a comment separates them;
# - rejects a comment directly after the magic number.


def _decode_pnm(data: bytes) -> MapImage:
    kind = data[1:2]
    header = (_BITMAP_HEADER if kind in b"14" else _SAMPLES_HEADER).match(data)
    if header is None:
        raise ValueError(f"the PNM header is invalid: {data[:40]!r}")
    width, height, largest = (*map(int, header.groups()), 1)[:3]
    _check_size(width, height)
    if not 1 <= largest <= 65535:
        raise ValueError(f"the largest sample of a PNM image must be from 1 to 65535, got {largest}")
    channels = 3 if kind in b"36" else 1
    shape = (height, width * channels)
    if kind in b"14":
        read_bits = _ascii_bits if kind == b"1" else _packed_bits
        return MapImage(np.where(read_bits(data, header.end(), shape), np.uint8(0), np.uint8(255)), None)
    read_samples = _ascii_samples if kind in b"23" else _binary_samples
    levels = _to_8_bits(read_samples(data, header.end(), shape, largest), largest)
    if channels == 1:
        return MapImage(levels, None)
    from PIL.Image import fromarray

    return MapImage(_luma(fromarray(levels.reshape(height, width, 3))), None)


def _ascii_bits(data: bytes, start: int, shape: tuple[int, int]) -> NDArray[np.uint8]:
    digits = _without_comments(data, start, b"01").translate(None, _WHITE_SPACE)
    return _first_samples(np.frombuffer(digits, np.uint8), shape) - ord("0")


def _packed_bits(data: bytes, start: int, shape: tuple[int, int]) -> NDArray[np.uint8]:
    height, width = shape
    rows = _first_samples(np.frombuffer(data, np.uint8, offset=start), (height, -(-width // 8)))
    return np.unpackbits(rows, axis=1, count=width)


def _ascii_samples(data: bytes, start: int, shape: tuple[int, int], largest: int) -> NDArray[np.uint16]:
    samples = _first_samples(np.fromstring(_without_comments(data, start, b"0123456789"), np.int64, sep=" "), shape)
    if samples.max() > largest:
        raise ValueError(f"samples must be at most {largest}, got {samples.max()}")
    return samples.astype(np.uint16)


def _binary_samples(data: bytes, start: int, shape: tuple[int, int], largest: int) -> NDArray[np.unsignedinteger]:
    dtype = np.dtype(">u2" if largest > 255 else "u1")
    count = (len(data) - start) // dtype.itemsize
    return _first_samples(np.frombuffer(data, dtype, count, start), shape)


def _without_comments(data: bytes, start: int, digits: bytes) -> bytes:
    text = re.sub(rb"#[^\r\n]*", b"", data[start:])
    invalid = text.translate(None, digits + _WHITE_SPACE)
    if invalid:
        raise ValueError(f"ASCII samples must be numbers, got {invalid[:8]!r}")
    return text.strip()  # np.fromstring would read white space alone as one zero.


def _first_samples(samples: NDArray[_Sample], shape: tuple[int, int]) -> NDArray[_Sample]:
    """The first samples in the given shape; the rest of the file is ignored."""
    count = shape[0] * shape[1]
    if samples.size < count:
        raise ValueError(f"the file is truncated: {samples.size} of {count} samples")
    return samples[:count].reshape(shape)


def _check_size(width: int, height: int, most: int = _MAX_PIXELS) -> None:
    if not 0 < width * height <= most:
        raise ValueError(f"an image must have from 1 to {most} pixels, got {width} x {height}")
