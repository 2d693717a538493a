"""plan: every wrong value is an error that says what is needed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from datasets.small_plans import small
from mobile_robot_simulator.datasets import Plan, load_plan

WRONG: list[tuple[dict[str, Any], str]] = [
    ({"count": 0}, "count must be greater than or equal to 1, got 0"),
    ({"count": True}, "count must be a number, got True"),
    ({"seed": -1}, "seed must be in 0..2**64 - 1, got -1"),
    ({"maps": [{"file": "m.yaml"}]}, "unknown name in the plan: maps[0].file; did you mean files?"),
    ({"maps": [{"floor_plan": "office", "seed": 3}]}, "unknown name in the plan: maps[0].seed; did you mean seeds?"),
    ({"poses": {"twist": {"wzz": 1}}}, "unknown name in the plan: poses.twist.wzz; did you mean wz?"),
    ({"surfaces": {"correlatoin": 1}}, "unknown name in the plan: surfaces.correlatoin; did you mean correlation?"),
    ({"maps": [{}]}, "maps[0]: each entry of maps must have either files or floor_plan"),
    (
        {"maps": [{"floor_plan": "ofice"}]},
        "floor_plan must be one of office, corridor, maze, cave, warehouse, got 'ofice'; did you",
    ),
    ({"noise": {"sigma_hit": [0.2, 0.1]}}, "noise.sigma_hit must be [low, high] with low at most high, got"),
    (
        {"noise": {"sigma_hit": "much"}},
        "noise.sigma_hit must be a number, or two numbers [low, high] to draw from, got 'much'",
    ),
    ({"noise": None, "surfaces": {}}, "surfaces need noise, got none"),
    ({"surfaces": {"correlation": [0.5, 1.5]}}, "surfaces: correlation must be in 0..1, got 1.5"),
    ({"surfaces": {"sigma": 0.1}}, "unknown name in the plan: surfaces.sigma"),
    ({"noise": {"sigma": 0.1}}, "unknown name in the plan: noise.sigma; did you mean sigma_hit?"),
    ({"noise": {"z_hit": 0, "z_max": 0}}, "noise: "),
    ({"scanner": {"fov": 270.0}}, "scanner: "),
    ({"scanner": {"max_range": [0.01, 9]}}, "scanner: max_range must be above min_range, 0.05 m, got 0.01 m"),
    ({"scanner": {"mount": [0, 1]}}, "scanner: mount must have 3 or 6 numbers, got 2"),
    ({"splits": {}}, "splits must have at least one split, got none"),
    ({"splits": {"../x": 1}}, "splits.../x"),
    ({"splits": {"train": 0}}, "splits.train must be greater than 0, got 0"),
    ({"labels": ["colour"]}, "labels[0] must be"),
    ({"labels": ["twists", "twists"]}, "labels must differ"),
    ({"labels": ["goals"]}, "only drives have goals"),
    ({"labels": ["beam_poses"]}, "beam_poses need a scanner with a scan_duration above 0"),
    ({"scans_per_scene": 3}, "scans_per_shard must be a multiple of scans_per_scene, got 32 and 3"),
    ({"poses": {"kind": "file"}}, "poses must have a file if kind is file"),
    ({"poses": {"kind": "drives", "policy": "x"}}, "policy must be like package.module:name, got 'x'"),
    ({"poses": {"policy": "a:b"}}, "poses must have a policy only if kind is drives"),
    ({"quantization": 2.0}, "quantization must be less than or equal to 1, got 2.0"),
    ({"poses": {"robot": {"robot_radius": 0.3}}}, "poses must have a robot only if kind is drives"),
    (
        {"poses": {"kind": "drives", "robot": {"laser_beam_count": 3}}},
        "poses: robot must have parameters of the robot, got laser_beam_count; the scanner is given as scanner",
    ),
    (
        {"poses": {"kind": "drives", "robot": {"velcity_limits": 3}}},
        "poses: unknown parameter 'velcity_limits'; did you mean 'velocity_limits'?",
    ),
    ({"labels": ["commands"]}, "only drives have commands, got poses of kind free"),
    ({"labels": ["goal_distances"]}, "only drives have goal_distances"),
    ({"cuont": 3}, "unknown name in the plan: cuont; did you mean count?"),
]


@pytest.mark.parametrize(("changes", "message"), WRONG, ids=lambda value: str(value)[:40])
def test_a_wrong_value(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as error:
        small(**changes)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"maps": "office"}, "maps must be a list, got 'office'"),
        ({"maps": []}, "maps must have at least 1 item, got []"),
        (
            {"maps": [{"floor_plan": "maze", "size": [1, 2, 3]}]},
            "maps[0].size must have at most 2 items, got [1, 2, 3]",
        ),
        ({"scanner": {"sigma_hit": 1}}, "unknown name in the plan: scanner.sigma_hit"),  # That is a name of the noise.
        ({"maps": ["maze"]}, "maps[0] must be a mapping of names to values, got 'maze'"),
        ({"maps": [{"floor_plan": "maze", "size": 3}]}, "maps[0].size must be a list, got 3"),
        ({"maps": [{"files": [1]}]}, "maps[0].files[0] must be a text, got 1"),
        ({"labels": "twists"}, "labels must be a list, got 'twists'"),
        ({"splits": ["train"]}, "splits must be a mapping of names to values, got ['train']"),
        ({"scanner": 3}, "scanner must be a mapping of names to values, got 3"),
        ({"self": 1}, "unknown name in the plan: self"),
    ],
)
def test_messages_speak_of_what_a_file_has(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as error:
        small(**changes)
    assert str(error.value) == message


def test_the_folder_of_a_plan_is_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plan.yaml").write_text("count: 10\nmaps: [{files: 'a/*.yaml'}]\n")
    assert load_plan("plan.yaml").folder == tmp_path


def test_a_missing_name() -> None:
    with pytest.raises(ValueError, match=r"^count is required; maps is required$"):
        Plan()


def test_a_file_is_read_with_its_folder(tmp_path: Path) -> None:
    file = tmp_path / "plan.yaml"
    file.write_text("count: 10\nmaps: [{files: 'a/*.yaml'}]\nnoise: {sigma_hit: 0.1}\n")
    plan = load_plan(file)
    assert plan.folder == tmp_path and plan.noise is not None and plan.noise.sigma_hit == (0.1, 0.1)
    assert plan.maps[0].files == ("a/*.yaml",)
    assert Plan(**plan.content).content == plan.content and "folder" not in plan.content


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("- 1", "a plan must be a mapping of names to values, got [1]"),
        ("count: [", "not valid YAML"),
        ("folder: /x", "folder"),
    ],
)
def test_a_file_that_is_no_plan(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "plan.yaml"
    file.write_text(text)
    with pytest.raises(ValueError) as error:
        load_plan(file)
    assert str(file) in str(error.value) and message in str(error.value)


@pytest.mark.parametrize(("shard", "scene", "chunk"), [(4096, 256, 512), (32, 8, 32), (1000, 10, 500), (1021, 1021, 1)])
def test_chunks_divide_a_shard(shard: int, scene: int, chunk: int) -> None:
    assert small(scans_per_shard=shard, scans_per_scene=scene).scans_per_chunk == chunk
