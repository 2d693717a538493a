"""The folder of a recording: no older recording and no other file is lost."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording.recorder import Format, Recorder, recover
from recordings import FORMATS, contents, drive, read, record


@pytest.mark.parametrize("old", FORMATS)
@pytest.mark.parametrize("new", FORMATS)
def test_an_older_recording_is_kept_unless_overwritten(tmp_path: Path, old: Format, new: Format) -> None:
    (tmp_path / "drive.png").write_text("a picture")
    path = record(tmp_path, old, drive(2))
    before = contents(path)
    with pytest.raises(FileExistsError, match="--overwrite") as raised:
        Recorder(tmp_path, format=new)
    assert raised.value.filename == str(path)
    assert contents(path) == before

    with Recorder(tmp_path, format=new, overwrite=True) as recorder:
        recorder.write("/clock", ros.Clock(), 5)
    assert {item.name for item in tmp_path.iterdir()} == {"drive.png", recorder.path.name}
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [5]


@pytest.mark.parametrize("format", FORMATS)
def test_an_older_recording_is_restored_if_the_new_one_cannot_begin(
    tmp_path: Path, format: Format, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = record(tmp_path, "mcap", drive(2))
    before = contents(path)

    def full(writer: Any) -> None:
        if format != "bag":
            writer.path.mkdir()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(f"rosbags.rosbag{1 if format == 'bag' else 2}.Writer.open", full)
    with pytest.raises(OSError, match="No space left"):
        Recorder(tmp_path, format=format, overwrite=True)
    assert list(tmp_path.iterdir()) == [path]
    assert contents(path) == before


def a_file(path: Path) -> None:
    path.write_text("not a recording")


def a_folder_with_more(path: Path) -> None:
    path.mkdir()
    (path / "metadata.yaml").touch()
    (path / "thesis.tex").touch()


def a_link(path: Path) -> None:
    (path.parent / "elsewhere").mkdir()
    path.symlink_to("elsewhere")


@pytest.mark.parametrize("name", ["recording", "recording.bag"])
@pytest.mark.parametrize("make", [a_file, a_folder_with_more, a_link])
def test_other_files_with_a_recordings_name_are_never_removed(
    tmp_path: Path, name: str, make: Callable[[Path], None]
) -> None:
    make(tmp_path / name)
    before = sorted(tmp_path.rglob("*"))
    for format in FORMATS:
        with pytest.raises(FileExistsError, match=f"not a recording.*{name}'"):
            Recorder(tmp_path, format=format, overwrite=True)
    assert sorted(tmp_path.rglob("*")) == before


COMPANION = "drive.png"


@pytest.mark.parametrize("format", FORMATS)
def test_companions_are_kept_or_replaced_with_their_recording(tmp_path: Path, format: Format) -> None:
    for name in (COMPANION, "notes.txt"):
        (tmp_path / name).write_text("older")
    with pytest.raises(FileExistsError, match=r"which is kept\. To replace it, use --overwrite .*drive\.png'"):
        Recorder(tmp_path, format=format, companions=[COMPANION])
    assert {item.name for item in tmp_path.iterdir()} == {COMPANION, "notes.txt"}
    with Recorder(tmp_path, format=format, overwrite=True, companions=[COMPANION]) as recorder:
        assert (tmp_path / COMPANION).read_text() == "older"
    assert {item.name for item in tmp_path.iterdir()} == {recorder.path.name, "notes.txt"}


def test_a_recovered_recording_replaces_the_companions_of_the_older_one(tmp_path: Path) -> None:
    record(tmp_path, "mcap", drive(2))
    (tmp_path / COMPANION).write_text("older")
    broken_off = record(tmp_path / "new", "bag", drive(3))
    (tmp_path / "recording.unfinished").mkdir()
    broken_off.rename(tmp_path / "recording.unfinished" / "recording.bag")
    path, _ = recover(tmp_path, overwrite=True, companions=[COMPANION])
    assert {item.name for item in tmp_path.iterdir()} == {path.name, "new"}


def test_a_folder_is_no_companion(tmp_path: Path) -> None:
    (tmp_path / COMPANION).mkdir()
    with pytest.raises(FileExistsError, match=r"It is not a file: '.*drive\.png'"):
        Recorder(tmp_path, overwrite=True, companions=[COMPANION])
    assert [item.name for item in tmp_path.iterdir()] == [COMPANION]


def test_companions_and_recording_stay_together_if_the_new_one_cannot_be_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = record(tmp_path, "mcap", drive(2))
    (tmp_path / COMPANION).write_text("older")
    before, rename = contents(path), Path.rename

    def broken(source: Path, target: Path) -> Path:
        if source.name == "recording.bag" and target.parent == tmp_path:
            assert [item.name for item in tmp_path.iterdir()] == ["recording.unfinished"]
            raise OSError(5, "Input/output error")
        return rename(source, target)

    recorder = Recorder(tmp_path, format="bag", overwrite=True, companions=[COMPANION])
    monkeypatch.setattr(Path, "rename", broken)
    with pytest.raises(OSError, match="Input/output error"):
        recorder.close()
    assert contents(path) == before and (tmp_path / COMPANION).read_text() == "older"
    monkeypatch.undo()
    assert recover(tmp_path, overwrite=True, companions=[COMPANION]) == (tmp_path / "recording.bag", 0)
    assert {item.name for item in tmp_path.iterdir()} == {"recording.bag"}


@pytest.mark.parametrize("format", FORMATS)
def test_new_companions_come_to_their_places_with_the_recording(tmp_path: Path, format: Format) -> None:
    recorder = Recorder(tmp_path, format=format, companions=[COMPANION])
    recorder.write("/clock", ros.Clock(), 5)
    with pytest.raises(ValueError, match=r"name must be one of the companions .*drive\.png.*, got 'notes\.txt'"):
        recorder.companion("notes.txt")
    recorder.companion(COMPANION).write_text("new")
    assert recorder.companion(COMPANION).read_text() == "new"
    with pytest.raises(ValueError, match="is closed"):
        recorder.write("/clock", ros.Clock(), 6)
    assert [item.name for item in tmp_path.iterdir()] == ["recording.unfinished"]
    recorder.close()
    with pytest.raises(ValueError, match="is closed"):
        recorder.companion(COMPANION)
    assert {item.name for item in tmp_path.iterdir()} == {recorder.path.name, COMPANION}
    assert (tmp_path / COMPANION).read_text() == "new" and len(read(recorder.path)) == 1


@pytest.mark.parametrize("format", FORMATS)
def test_without_its_companion_a_recording_stays_unfinished(tmp_path: Path, format: Format) -> None:
    before = contents(record(tmp_path, "mcap", drive(2)))
    (tmp_path / COMPANION).write_text("older")
    with (
        pytest.raises(OSError, match=rf"No space left\. The recording was broken off; .* recover {tmp_path}` recovers"),
        Recorder(tmp_path, format=format, overwrite=True, companions=[COMPANION]) as recorder,
    ):
        recorder.write("/clock", ros.Clock(), 5)
        recorder.companion(COMPANION)
        raise OSError(28, "No space left")
    assert contents(tmp_path / "recording") == before and (tmp_path / COMPANION).read_text() == "older"
    path, count = recover(tmp_path, overwrite=True, companions=[COMPANION])
    assert (path, count) == (recorder.path, 1) and [item.name for item in tmp_path.iterdir()] == [path.name]


def test_a_recovered_recording_does_not_replace_other_files_with_its_companions(tmp_path: Path) -> None:
    new = tmp_path / "recording.unfinished" / "complete"
    new.mkdir(parents=True)
    (new / COMPANION).write_text("new")
    record(tmp_path / "elsewhere", "bag", drive(2)).rename(new / "recording.bag")
    (tmp_path / COMPANION).write_text("mine")
    with pytest.raises(FileExistsError, match=r"which is kept\. To replace it, use --overwrite .*drive\.png'"):
        recover(tmp_path)
    assert (tmp_path / COMPANION).read_text() == "mine"
    recover(tmp_path, overwrite=True)
    assert (tmp_path / COMPANION).read_text() == "new"


@pytest.mark.parametrize("format", FORMATS)
def test_a_discarded_recording_leaves_the_older_one(tmp_path: Path, format: Format) -> None:
    before = contents(record(tmp_path, "mcap", drive(2)))
    recorder = Recorder(tmp_path, format=format, overwrite=True)
    recorder.write("/clock", ros.Clock(), 5)
    recorder.discard()
    recorder.close()
    recorder.discard()
    assert [item.name for item in tmp_path.iterdir()] == ["recording"]
    assert contents(tmp_path / "recording") == before


def test_a_file_in_place_of_the_folder_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "out").touch()
    for path in (tmp_path / "out", tmp_path / "out" / "deep"):
        for call in (Recorder, recover):
            with pytest.raises(NotADirectoryError, match="Must be a folder") as raised:
                call(path)
            assert raised.value.filename == str(tmp_path / "out")


@pytest.mark.parametrize("overwrite", [False, True])
def test_two_recordings_at_a_time_in_one_folder_are_an_error(tmp_path: Path, overwrite: bool) -> None:
    with Recorder(tmp_path) as recorder:
        with pytest.raises(BlockingIOError, match="Another process is recording") as raised:
            Recorder(tmp_path, overwrite=overwrite)
        assert raised.value.filename == str(tmp_path)
        recorder.write("/clock", ros.Clock(), 5)
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [5]


def test_an_older_recording_is_kept_until_the_new_one_is_complete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = record(tmp_path, "mcap", drive(2))
    before = contents(path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("rosbags.rosbag2.Writer.close", full)
    recorder = Recorder(tmp_path, overwrite=True)
    assert contents(path) == before
    with pytest.raises(OSError, match="No space left"):
        recorder.close()
    assert contents(path) == before


@pytest.mark.parametrize("format", FORMATS)
def test_a_recording_stays_in_its_folder_if_the_working_directory_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, format: Format
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    with Recorder("out", format=format, companions=["note"]) as recorder:
        recorder.write("/clock", ros.Clock(), 5)
        before = recorder.path
        monkeypatch.chdir("elsewhere")
        recorder.companion("note").touch()
    assert before.parent == Path("out")
    assert recorder.path == tmp_path / before
    assert (tmp_path / "out" / "note").is_file()
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [5]
    assert list(Path().iterdir()) == []


def test_errors_name_the_folder_as_the_caller_did_while_that_leads_to_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    for directory, shown in ((tmp_path, Path("out")), (tmp_path / "elsewhere", tmp_path / "out")):
        monkeypatch.chdir(tmp_path)
        recorder = Recorder("out", overwrite=True)
        with monkeypatch.context() as patch:
            patch.setattr("rosbags.rosbag2.Writer.close", _no_space)
            monkeypatch.chdir(directory)
            with pytest.raises(OSError, match=f"`mobile-robot-simulator recover {shown}`") as raised:
                recorder.close()
        assert raised.value.filename == str(shown / "recording.unfinished")


def _no_space(*_: object) -> None:
    raise OSError(28, "No space left on device")
