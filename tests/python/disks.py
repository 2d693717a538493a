"""Small disks to fill, and folders that cannot be written. Root ignores permissions, so its tests mount small disks."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


@contextmanager
def small_disk(kilobytes: int) -> Iterator[Path]:
    """Yields a folder on a disk of its own of this size. Skips the test if no disk can be mounted."""
    with tempfile.TemporaryDirectory() as name, _mounted(name, "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs"):
        yield Path(name)


@contextmanager
def read_only_folder(folder: Path) -> Iterator[None]:
    """Makes an existing folder read-only meanwhile. Skips the test if root cannot mount it so, and on Windows."""
    if sys.platform == "win32":
        pytest.skip("Windows has no read-only folders")
    if os.geteuid():
        folder.chmod(0o555)
        try:
            yield
        finally:
            folder.chmod(0o755)
        return
    with _mounted(folder, "--bind", str(folder)):
        subprocess.run(["mount", "-o", "remount,ro,bind", str(folder)], check=True, timeout=60)
        yield


@contextmanager
def _mounted(folder: Path | str, *options: str) -> Iterator[None]:
    try:
        subprocess.run(["mount", *options, str(folder)], check=True, capture_output=True, timeout=60)
    except (OSError, subprocess.CalledProcessError) as error:
        pytest.skip(f"this test has to mount a disk, which needs root: {error}")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True, timeout=60)
