"""The command scan."""

import json

import pytest


def test_scan_prints_json(command, room):
    done = command("scan", room, "--pose", 3.0, 2.0, 0.0, "--json", "-p", "apply_noise:=false", "-p", "laser_beam_count:=3")
    content = json.loads(done.stdout)
    assert content["ranges"][1] == pytest.approx(2.95, abs=1e-6)
    assert len(content["ranges"]) == 3 and content["range_max"] == 30.0


@pytest.mark.slow
def test_scan_saves_a_picture(command, room, tmp_path):
    pytest.importorskip("matplotlib", reason="the extra `plotting` is not installed")
    picture = tmp_path / "scan.png"
    done = command("scan", room, "--pose", 3, 2, 0, "--plot", picture)
    assert done.returncode == 0 and picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(("x", "words"), [(0.02, "inside a wall"), (-5.0, "off the map"), (3.0, None)])
def test_scan_says_when_the_scanner_is_not_in_free_space(command, room, x, words):
    done = command("scan", room, "--pose", x, 2, 0)
    assert done.returncode == 0, done.stderr
    assert [each for each in ("inside a wall", "off the map") if each in done.stdout] == ([words] if words else [])
