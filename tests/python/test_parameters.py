"""parameters: names, defaults and checks; from YAML and command lines, and back."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mobile_robot_simulator import parameters
from mobile_robot_simulator.parameters import LaserParameters, Parameters, RobotParameters

# The original's names and defaults, which other people's launch files use.
ROBOT = {
    "publish_map_transform": False,
    "publish_rate": 10.0,
    "velocity_topic": "/cmd_vel",
    "odometry_topic": "/odom",
    "base_link_frame": "base_link",
    "cmd_vel_stamped": True,
    "speed_factor": 1.0,
    "velocity_timeout": 0.5,
}
LASER = {
    "laser_topic": "/scan",
    "map_service": "/static_map",
    "laser_frame_id": "base_link",
    "laser_fov": 4.71,
    "laser_beam_count": 541,
    "laser_max_range": 30.0,
    "laser_min_range": 0.05,
    "laser_frequency": 10.0,
    "apply_noise": True,
    "sigma_hit": 0.005,
    "lambda_short": 2.0,
    "z_hit": 0.995,
    "z_short": 0.0,
    "z_max": 0.005,
    "z_rand": 0.0,
    "no_return": "inf",
    "unknown": "free",
}


@pytest.mark.parametrize(
    ("model", "name", "default"),
    [(RobotParameters, *item) for item in ROBOT.items()] + [(LaserParameters, *item) for item in LASER.items()],
)
def test_names_and_defaults(model: type[Parameters], name: str, default: object) -> None:
    value = getattr(model(), name)
    assert value == default
    assert type(value) is type(default)
    assert model.model_fields[name].description


def test_the_seed_is_a_parameter() -> None:
    assert isinstance(LaserParameters().seed, int)


def test_node_names_are_the_originals() -> None:
    assert RobotParameters.node_name == "mobile_robot_simulator_node"
    assert LaserParameters.node_name == "laser_scanner_simulator_node"


# A mount needs a frame of its own.
FRAME: dict[type[Parameters], dict[str, str]] = {RobotParameters: {}, LaserParameters: {"laser_frame_id": "laser"}}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("publish_rate", 1e-3),
        ("publish_rate", 1000),
        ("velocity_timeout", 0),
        ("laser_fov", 2.0 * math.pi),
        ("laser_beam_count", 1),
        ("laser_min_range", 0.0),
        ("laser_beam_count", np.int64(181)),
        ("laser_max_range", np.float32(12.0)),
        ("seed", 2**64 - 1),
        ("z_hit", 17),
        ("laser_mount", [0.1, 0, -0.5]),
        ("laser_mount", None),
        ("sigma_hit", "0.05e0"),
    ],
)
def test_good_values_are_taken(name: str, value: Any) -> None:
    model = RobotParameters if name in RobotParameters.model_fields else LaserParameters
    found = getattr(model.checked({**FRAME[model], name: value}), name)
    assert found == (tuple(value) if isinstance(value, list) else 0.05 if value == "0.05e0" else value)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("publish_rate", 0.0, "publish_rate must be greater than 0, got 0.0"),
        ("publish_rate", -1, "publish_rate must be greater than 0, got -1"),
        ("publish_rate", math.nan, "publish_rate must be a finite number, got nan"),
        ("publish_rate", math.inf, "publish_rate must be"),
        ("publish_rate", "fast", "publish_rate must be a valid number"),
        ("publish_rate", True, "publish_rate must be a number, got True"),
        ("publish_rate", None, "publish_rate must be a valid number, got None"),
        ("publish_rate", [10.0], "publish_rate must be a valid number, got [10.0]"),
        ("speed_factor", 0.0, "speed_factor must be greater than 0"),
        ("velocity_timeout", -0.1, "velocity_timeout must be greater than or equal to 0, got -0.1"),
        ("velocity_topic", 5, "velocity_topic must be a valid string, got 5"),
        ("velocity_topic", "", "velocity_topic must"),
        ("publish_map_transform", "maybe", "publish_map_transform must be a valid boolean"),
        ("publish_map_transform", 7, "publish_map_transform must be a valid boolean"),
        ("laser_fov", 0.0, "laser_fov must be greater than 0, got 0.0"),
        ("laser_fov", 6.3, "laser_fov must be less than or equal to 6.28"),
        ("laser_beam_count", 0, "laser_beam_count must be greater than or equal to 1, got 0"),
        ("laser_beam_count", 541.5, "laser_beam_count must be a valid integer"),
        ("laser_beam_count", 10**9, "laser_beam_count must be less than or equal to 1000000, got 1000000000"),
        ("laser_max_range", 0.05, "laser_min_range must be less than laser_max_range 0.05, got 0.05"),
        ("laser_max_range", -1.0, "laser_max_range must be greater than 0, got -1.0"),
        ("laser_min_range", 30.0, "laser_min_range must be less than laser_max_range 30.0, got 30.0"),
        ("laser_min_range", -0.1, "laser_min_range must be greater than or equal to 0, got -0.1"),
        ("laser_frequency", 0.0, "laser_frequency must be greater than 0, got 0.0"),
        ("sigma_hit", 0.0, "sigma_hit must be greater than 0, got 0.0"),
        ("lambda_short", -2.0, "lambda_short must be greater than 0, got -2.0"),
        ("z_rand", -0.1, "z_rand must be greater than or equal to 0, got -0.1"),
        ("no_return", "nan", "no_return must be 'inf' or 'max', got 'nan'"),
        ("unknown", "maybe", "unknown must be 'free' or 'occupied', got 'maybe'"),
        ("seed", -1, "seed must be"),
        ("seed", 2**64, f"got {2**64}"),
        ("seed", 1.5, "seed must be a valid integer"),
        ("laser_mount", [0.0, 0.0], "laser_mount"),
        ("laser_mount", [0.0, 0.0, math.nan], "laser_mount"),
    ],
)
def test_bad_values_are_refused_by_name_value_and_need(name: str, value: Any, words: str) -> None:
    model = RobotParameters if name in RobotParameters.model_fields else LaserParameters
    with pytest.raises(ValueError) as caught:
        model.checked({name: value})
    assert words in str(caught.value)


def test_weights_that_are_all_zero_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one of z_hit, z_short, z_max, z_rand must be positive"):
        LaserParameters.checked({"z_hit": 0.0, "z_max": 0.0})


def test_all_that_is_wrong_is_said_at_once() -> None:
    with pytest.raises(ValueError) as caught:
        LaserParameters.checked({"laser_fov": -1.0, "sigma_hit": 0.0})
    assert "laser_fov" in str(caught.value) and "sigma_hit" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("laser_beams_count", "laser_beam_count"),
        ("laser_frequence", "laser_frequency"),
        ("publish_rat", "publish_rate"),
        ("sigma", "sigma_hit"),
    ],
)
def test_unknown_names_suggest_the_nearest(name: str, near: str) -> None:
    with pytest.raises(ValueError, match=f"unknown parameter '{name}'; did you mean '{near}'"):
        parameters.check_names([name])
    with pytest.raises(ValueError, match=f"did you mean '{near}'"):
        parameters.read_assignment(f"{name}:=1")


def test_changes_are_checked_and_leave_the_old_alone() -> None:
    old = LaserParameters()
    assert old.changed({"laser_fov": 1.0}).laser_fov == 1.0
    assert old.laser_fov == 4.71
    for bad in ({"laser_fov": -1.0}, {"laser_min_range": 99.0}, {"laser_fow": 1.0}):
        with pytest.raises(ValueError, match="laser_"):
            old.changed(bad)


# --- files ------------------------------------------------------------------------------------------------------------


def written(folder: Path, text: str) -> Path:
    path = folder / "parameters.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("/**:\n  ros__parameters:\n    laser_fov: 1.5\n    publish_rate: 20\n", {"laser_fov": 1.5, "publish_rate": 20}),
        ("laser_scanner_simulator_node:\n  ros__parameters:\n    seed: 5\n", {"seed": 5}),
        ("/mobile_robot_simulator_node:\n  ros__parameters:\n    publish_rate: 20.0\n", {"publish_rate": 20.0}),
        ("/**:\n  ros__parameters: {}\n", {}),
        (
            "laser_scanner_simulator_node:\n  ros__parameters: {seed: 5}\n/**:\n  ros__parameters: {seed: 6, z_hit: 1}\n",
            {"seed": 5, "z_hit": 1},
        ),
        ("/**:\n  ros__parameters:\n    sigma_hit: 0.05e0\n", {"sigma_hit": "0.05e0"}),
        (
            "/**: {ros__parameters: {laser_mount: [0.1, 0.0, 3.14], laser_frame_id: laser}}",
            {"laser_mount": [0.1, 0.0, 3.14], "laser_frame_id": "laser"},
        ),
    ],
)
def test_files_are_read(tmp_path: Path, text: str, values: dict[str, Any]) -> None:
    read = parameters.read_file(written(tmp_path, text))
    for model in parameters.NODES:
        assert parameters.for_node(model, read) == parameters.for_node(model, values)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "must hold nodes"),
        ("5", "must hold nodes"),
        ("- a\n- b\n", "must hold nodes"),
        ("laser_fov: 1.5\n", "unknown node 'laser_fov'"),
        ("/**:\n  laser_fov: 1.5\n", "ros__parameters"),
        ("/**:\n  ros__parameters: 5\n", "ros__parameters"),
        ("/**: 5\n", "ros__parameters"),
        ("/**:\n  ros__parameters:\n    laser_fow: 1.5\n", "unknown parameter 'laser_fow'; did you mean 'laser_fov'"),
        ("laser_scanner_node:\n  ros__parameters: {}\n", "did you mean 'laser_scanner_simulator_node'"),
        ("mobile_robot_simulator_node:\n  ros__parameters:\n    laser_fov: 1.5\n", "unknown parameter 'laser_fov'"),
        ("a: [1\n", "is not YAML"),
        ("a: b: c\n", "is not YAML"),
        ("a: \x07\n", "is not YAML"),
        ("? [1, 2]\n: 5\n", "is not YAML"),
        ("/**:\n  ros__parameters:\n    5: 1\n", "unknown parameter '5'"),
    ],
)
def test_bad_files_are_refused(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        parameters.read_file(written(tmp_path, text))
    assert words in str(caught.value)


def test_a_file_that_is_no_text_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "map.pgm"
    path.write_bytes(b"P5\n\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"map\.pgm"):
        parameters.read_file(path)


def test_a_file_that_is_missing_is_an_os_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="nowhere"):
        parameters.read_file(tmp_path / "nowhere.yaml")
    with pytest.raises(OSError, match=str(tmp_path)):
        parameters.read_file(tmp_path)


def test_each_node_keeps_its_own_value_of_a_name_that_both_have(tmp_path: Path) -> None:
    """What stands under one node's name is for that node."""
    path = written(
        tmp_path,
        "mobile_robot_simulator_node:\n  ros__parameters: {base_link_frame: base_footprint}\n"
        "laser_scanner_simulator_node:\n  ros__parameters: {seed: 5}\n",
    )
    values = parameters.read_file(path)
    assert parameters.for_node(RobotParameters, values).base_link_frame == "base_footprint"
    path = written(
        tmp_path,
        "mobile_robot_simulator_node:\n  ros__parameters: {map_frame_id: world}\n"
        "laser_scanner_simulator_node:\n  ros__parameters: {map_frame_id: map}\n",
    )
    values = parameters.read_file(path)
    assert parameters.for_node(RobotParameters, values).map_frame_id == "world"
    assert parameters.for_node(LaserParameters, values).map_frame_id == "map"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("publish_rate:=20", ("publish_rate", 20)),
        ("publish_rate:=2e1", ("publish_rate", "2e1")),
        ("laser_fov:=1.5", ("laser_fov", 1.5)),
        ("publish_map_transform:=true", ("publish_map_transform", True)),
        ("laser_topic:=/front/scan", ("laser_topic", "/front/scan")),
        ("laser_mount:=[0.1, 0.0, 0.0]", ("laser_mount", [0.1, 0.0, 0.0])),
        ("no_return:=max", ("no_return", "max")),
        ("laser_topic:=a:=b", ("laser_topic", "a:=b")),
    ],
)
def test_assignments_are_read(text: str, expected: tuple[str, Any]) -> None:
    assert parameters.read_assignment(text) == expected


def test_numbers_that_yaml_takes_for_text_are_numbers() -> None:
    name, value = parameters.read_assignment("publish_rate:=2e1")
    assert RobotParameters.checked({name: value}).publish_rate == 20.0


@pytest.mark.parametrize("text", ["publish_rate", "publish_rate=20", ":=20", "publish_rate: 20", ""])
def test_what_is_no_assignment_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="name:=value, got"):
        parameters.read_assignment(text)


def test_a_value_that_is_no_yaml_is_refused() -> None:
    with pytest.raises(ValueError, match="laser_mount must be YAML"):
        parameters.read_assignment("laser_mount:=[1, 2")


def read_back(folder: Path, text: str) -> dict[str, Any]:
    return parameters.read_file(written(folder, text))


def test_the_yaml_of_all_parameters_reads_back(tmp_path: Path) -> None:
    text = parameters.to_yaml()
    values = read_back(tmp_path, text)
    for model in parameters.NODES:
        assert parameters.for_node(model, values) == model()
        section = text.partition(f"{model.node_name}:")[2].splitlines()
        for name, info in model.model_fields.items():
            assert next(line for line in section if line.strip().startswith(f"{name}:")).endswith(f"# {info.description}")
    assert list(yaml.safe_load(text)) == [model.node_name for model in parameters.NODES]


texts = st.text(st.characters(blacklist_categories=("Cs", "Cc")), min_size=1, max_size=200)


@given(
    fov=st.floats(1e-300, 6.28),
    timeout=st.floats(0.0, 1e300),
    mount=st.none() | st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3),
    topic=st.from_regex(r"[~/]?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*", fullmatch=True),
    seed=st.integers(0, 2**64 - 1),
    noise=st.booleans(),
)
def test_any_values_read_back(
    tmp_path_factory: pytest.TempPathFactory, fov: float, timeout: float, mount: Any, topic: str, seed: int, noise: bool
) -> None:
    values = {
        "laser_fov": fov,
        "velocity_timeout": timeout,
        "laser_mount": mount,
        "laser_frame_id": "laser",
        "laser_topic": topic,
        "seed": seed,
        "apply_noise": noise,
    }
    read = read_back(tmp_path_factory.mktemp("parameters"), parameters.to_yaml(values))
    for model in parameters.NODES:
        assert parameters.for_node(model, read) == parameters.for_node(model, values)


def test_the_yaml_of_unknown_values_is_refused() -> None:
    with pytest.raises(ValueError, match="laser_fow"):
        parameters.to_yaml({"laser_fow": 1.0})
