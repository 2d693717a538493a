"""user_files: only regular files up to a limit are read, whichever reader the user's path reaches."""

from __future__ import annotations

import ast
import io
import os
import socket
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.script import Script
from mobile_robot_simulator.parameter_files import read_file
from mobile_robot_simulator.recording import Recorder
from mobile_robot_simulator.user_files import read_bytes, read_text

PACKAGE = Path(mrs.__file__).parent

MAP = "image: {image}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"

needs_fifos = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no FIFOs")
needs_devices = pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no /dev/zero")


def fifo(folder: Path) -> Path:
    path = folder / "fifo"
    os.mkfifo(path)
    return path


def read_map(path: Path) -> object:
    return mrs.load_map(path)


def read_image(path: Path) -> object:
    yaml = path.parent / "map.yaml" if os.access(path.parent, os.W_OK) and path.parent != Path("/dev") else Path("map.yaml")
    yaml.write_text(MAP.format(image=path.absolute()))
    return mrs.load_map(yaml)


READERS: list[Callable[[Path], object]] = [read_map, read_image, read_file, Script.read]


@needs_fifos
@pytest.mark.parametrize("read", READERS)
def test_no_reader_waits_for_the_other_end_of_a_fifo(tmp_path: Path, read: Callable[[Path], object]) -> None:
    with pytest.raises(OSError, match=r"Must be a regular file, got a FIFO.*fifo"):
        read(fifo(tmp_path))


@needs_devices
@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null"])
@pytest.mark.parametrize("read", READERS)
def test_no_reader_reads_a_device(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, read: Callable[[Path], object], device: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OSError, match=f"Must be a regular file, got a character device.*{device}"):
        read(Path(device))
    link = tmp_path / "link"
    link.symlink_to(device)
    with pytest.raises(OSError, match="Must be a regular file, got a character device"):
        read(link)


@pytest.mark.parametrize("read", READERS)
def test_no_reader_reads_a_file_that_is_too_large(tmp_path: Path, read: Callable[[Path], object]) -> None:
    path = tmp_path / "large.yaml"
    with path.open("wb") as file:
        file.truncate(2**40)  # takes no space on the disk
    with pytest.raises(OSError, match=r"Must have at most \d+ bytes, got 1099511627776 bytes.*large"):
        read(path)


@pytest.mark.parametrize("read", READERS)
def test_missing_files_and_folders_keep_their_errors(tmp_path: Path, read: Callable[[Path], object]) -> None:
    with pytest.raises(FileNotFoundError, match="nowhere"):
        read(tmp_path / "nowhere")
    (tmp_path / "folder").mkdir()
    with pytest.raises((IsADirectoryError, PermissionError), match="folder"):
        read(tmp_path / "folder")


@needs_fifos
def test_a_fifo_with_the_name_of_a_recording_is_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "recording.bag")
    with pytest.raises(FileExistsError, match="not a recording"):
        Recorder(tmp_path, overwrite=True)


@pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="this system has no sockets in folders")
def test_a_socket_is_an_os_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind("socket")
        with pytest.raises(OSError, match="socket"):
            read_bytes("socket", 10)


def test_a_file_of_exactly_the_limit_is_read(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    assert read_bytes(path, 10) == b"0123456789"
    with pytest.raises(OSError, match="Must have at most 9 bytes, got 10 bytes"):
        read_bytes(str(path), 9)
    (tmp_path / "link").symlink_to(path)
    assert read_bytes(tmp_path / "link", 10) == b"0123456789"


@pytest.mark.skipif(not Path("/proc/version").exists(), reason="this system has no /proc")
def test_a_file_that_is_longer_than_it_says_is_read_up_to_the_limit() -> None:
    content = Path("/proc/version").read_bytes()
    assert Path("/proc/version").stat().st_size == 0 < len(content)
    assert read_bytes("/proc/version", len(content)) == content
    with pytest.raises(OSError, match=f"Must have at most {len(content) - 1} bytes, got more"):
        read_bytes("/proc/version", len(content) - 1)


@pytest.mark.parametrize(
    "data",
    [
        "a: ä\n".encode(),
        b"\xef\xbb\xbf" + "a: ä\n".encode(),
        "a: ä\n".encode("utf-16"),
        "\ufeffa: ä\n".encode("utf-16-be"),
        "a: ä\n".encode("utf-16-le"),
        "a: ä\n".encode("utf-16-be"),
        "a: ä\n".encode("utf-32"),
    ],
)
def test_text_is_read_in_the_encodings_of_its_mark(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "text"
    path.write_bytes(data)
    assert read_text(path) == "a: ä\n"


def test_bytes_that_are_not_utf_8_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(b"caf\xe9")
    assert read_text(path).encode("utf-8", "surrogateescape") == b"caf\xe9"


@pytest.mark.parametrize(
    ("data", "message"),
    [(b"first\nsec\0nd", "must be text, got a NUL character in line 2"), (b"\xff\xfea", "not utf-16-le text: truncated")],
)
def test_data_that_is_not_text_is_rejected(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "data"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=message) as caught:
        read_text(path)
    assert str(caught.value).startswith(f"{path}: ")


class Standard:
    """Standard input with these bytes."""

    def __init__(self, data: bytes) -> None:
        self.buffer = io.BytesIO(data)


def test_standard_input_is_read_up_to_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Standard(b"0123456789"))
    assert read_text("-", 10, allow_stdin=True) == "0123456789"
    monkeypatch.setattr(sys, "stdin", Standard(b"0123456789"))
    with pytest.raises(OSError, match="Must have at most 9 bytes, got more"):
        read_text("-", 9, allow_stdin=True)
    with pytest.raises(FileNotFoundError):
        read_text("-", 10)


OPENS_ITSELF = {
    "user_files.py": "the owner",
    "new_files.py": "opens only its drafts, for writing",
    "recording/folder.py": "looks at the first bytes of a recording, after it has checked that this is a file",
    "recording/mcap_storage.py": "opens the file that it writes",
    "recording/complete_messages.py": "copies and reads the files of a recording, which can be of any size",
    "recording/bag.py": "opens bags with rosbags",
    "logs/carmen.py": "unpacks a file that user_files has opened",
}


def test_nothing_else_in_the_package_opens_files_for_reading() -> None:
    readers = {"open", "read_text", "read_bytes", "fromfile", "loadtxt", "genfromtxt", "imread", "fdopen"}
    found = set()
    for path in PACKAGE.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        from_owner = {
            alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and node.module == "user_files"
            for alias in node.names
        }
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call):
                continue
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            opens_writer = isinstance(node.func, ast.Attribute) and ast.unparse(node.func.value) == "self._writer"
            if name in readers and name not in from_owner and not opens_writer:
                found.add(str(path.relative_to(PACKAGE)))
    assert found == set(OPENS_ITSELF)
