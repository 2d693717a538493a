"""new_files: files are written completely or not at all, and nothing else in the package writes files."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from disks import read_only_folder, small_disk
from mobile_robot_simulator.cli.summary import Summary
from mobile_robot_simulator.new_files import write_files

PACKAGE = Path(mrs.__file__).parent


def save_map(folder: Path) -> None:
    mrs.save_map(mrs.OccupancyGrid(np.zeros((300, 300), np.int8), resolution=0.05), folder / "map.yaml")


def save_picture(folder: Path) -> None:
    pytest.importorskip("matplotlib", reason="the extra `plotting` is not installed")
    mrs.Simulation(mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)).draw(folder / "drive.png")


def save_summary(folder: Path) -> None:
    Summary(1.0, 1.0, 1.0, 1, 1, 1.0, 1.0, 0, 0.0, (0, 0, 0), (0, 0, 0), 1, False).save(folder / "summary.json")


SAVERS: dict[Callable[[Path], None], list[str]] = {
    save_map: ["map.pgm", "map.yaml"],
    save_picture: ["drive.png"],
    save_summary: ["summary.json"],
}
"""Everything that writes files, and their names."""

savers = pytest.mark.parametrize("save", SAVERS, ids=lambda save: save.__name__)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def assert_nothing_is_lost(save: Callable[[Path], None], folder: Path, older: dict[str, bytes], reason: str) -> None:
    """Asserts that saving fails with the reason and a path of the user, and changes nothing."""
    with pytest.raises(OSError, match=reason) as raised:
        save(folder)
    assert raised.value.filename in [str(folder / name) for name in SAVERS[save]]
    assert "\n" not in str(raised.value)
    assert contents(folder) == older


FULL = "No space left on device; the file was not written, an older one is kept"


@pytest.mark.parametrize(
    ("save", "left"), [(save_map, 0), (save_map, 8), (save_picture, 0), (save_picture, 8), (save_summary, 0)]
)
def test_a_full_disk_loses_nothing(save: Callable[[Path], None], left: int) -> None:
    with small_disk(kilobytes=64) as folder:
        for name in SAVERS[save]:
            (folder / name).write_bytes(b"older")
        (folder / "more").write_bytes(bytes(1024 * (64 - left - 4 * len(SAVERS[save]))))
        assert_nothing_is_lost(save, folder, contents(folder), FULL)


@savers
def test_a_read_only_folder_is_an_error(tmp_path: Path, save: Callable[[Path], None]) -> None:
    with read_only_folder(tmp_path):
        assert_nothing_is_lost(save, tmp_path, {}, "(Read-only file system|Permission denied); the file was not written")


@savers
def test_a_read_only_folder_loses_nothing(tmp_path: Path, save: Callable[[Path], None]) -> None:
    for name in SAVERS[save]:
        (tmp_path / name).write_bytes(b"older")
    with read_only_folder(tmp_path):
        # On a read-only disk, the files cannot be written either.
        reason = "Cannot replace a write-protected file|Permission denied; the file was not written, an older one is kept"
        assert_nothing_is_lost(save, tmp_path, contents(tmp_path), reason)


LIMITED = """
import resource, signal, sys
from pathlib import Path
from mobile_robot_simulator.new_files import write_files
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
write_files({Path(sys.argv[1], "a"): b"new", Path(sys.argv[1], "b"): bytes(1001)})
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit of files")
def test_all_files_are_complete_before_the_first_one_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"older")
    done = subprocess.run([sys.executable, "-c", LIMITED, str(tmp_path)], capture_output=True, text=True, timeout=60)
    assert done.stderr.splitlines()[-1] == (
        f"OSError: [Errno 27] File too large; the file was not written, an older one is kept: '{tmp_path / 'b'}'"
    )
    assert contents(tmp_path) == {"a": b"older"}


def test_files_are_replaced_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").write_bytes(b"older")
    replaced = []
    replace = os.replace

    def noting(source: Path, target: Path) -> None:
        replaced.append(Path(target).name)
        replace(source, target)

    monkeypatch.setattr(os, "replace", noting)
    write_files({tmp_path / "b": b"1", tmp_path / "a": b"2"})
    assert replaced == ["b", "a"] and contents(tmp_path) == {"a": b"2", "b": b"1"}


def test_a_new_file_has_the_usual_permissions(tmp_path: Path) -> None:
    (tmp_path / "usual").touch()
    write_files({tmp_path / "new": b"1"})
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_link_stays_and_its_file_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "file").write_bytes(b"older")
    (tmp_path / "link").symlink_to("maps/file")
    write_files({tmp_path / "link": b"new"})
    assert (tmp_path / "link").is_symlink() and contents(tmp_path / "maps") == {"file": b"new"}


def test_missing_folders_are_not_made(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"no such folder: '.*nowhere'"):
        write_files({tmp_path / "a": b"1", tmp_path / "nowhere" / "b": b"2"})
    assert list(tmp_path.iterdir()) == []


def test_folders_and_special_files_are_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(IsADirectoryError, match=r"over a folder: '.*folder'"):
        write_files({tmp_path / "folder": b"1"})
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "fifo")
        with pytest.raises(OSError, match=r"not a regular file: '.*fifo'"):
            write_files({tmp_path / "fifo": b"1"})
        assert (tmp_path / "fifo").is_fifo()


def test_a_write_protected_file_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "file"
    file.write_bytes(b"older")
    file.chmod(0o444)
    if os.access(file, os.W_OK):  # Root can write it; then only the question is tested.
        monkeypatch.setattr(os, "access", lambda path, mode: (path, mode) != (file.resolve(), os.W_OK))
    with pytest.raises(PermissionError, match=r"write-protected file: '.*file'"):
        write_files({file: b"new"})
    assert contents(tmp_path) == {"file": b"older"}


WRITES_ITSELF = {
    "new_files.py": "the owner",
    "recording/folder.py": "moves recordings to their place",
    "recording/mcap_storage.py": "writes the file of a bag in the folder that its caller moves to its place",
    "recording/complete_messages.py": "copies a bag without an end to a folder that its caller removes",
    "datasets/export.py": "moves the folder that another library wrote to its place",
    "plotting/charts.py": "draws into memory",
    "plotting/picture.py": "draws into memory",
}


def test_nothing_else_in_the_package_writes_files() -> None:
    writers = {"write_text", "write_bytes", "savefig", "rename", "tofile", "savetxt", "mkstemp", "NamedTemporaryFile"}
    found = set()
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            modes = [
                each.value
                for each in [*node.args, *(each.value for each in node.keywords)]
                if isinstance(each, ast.Constant)
            ]
            opens = name in ("open", "fdopen") and any(isinstance(mode, str) and set("wax") & set(mode) for mode in modes)
            if name in writers or opens or ast.unparse(node.func) == "os.replace":
                found.add(str(path.relative_to(PACKAGE)))
    assert found == set(WRITES_ITSELF)
