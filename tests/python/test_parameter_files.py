"""parameter_files: parameter files and assignments are read, and written files read back the same."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mobile_robot_simulator.parameter_files import read_assignment, read_fault_texts, read_file, to_yaml, translated
from mobile_robot_simulator.parameters import NODES, LaserParameters, RobotParameters, for_node


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
    read = read_file(written(tmp_path, text))
    for model in NODES:
        assert for_node(model, read) == for_node(model, values)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "must contain node names"),
        ("5", "must contain node names"),
        ("- a\n- b\n", "must contain node names"),
        ("laser_fov: 1.5\n", "line 1: laser_fov must contain a mapping ros__parameters"),
        ("/**:\n  laser_fov: 1.5\n", "ros__parameters"),
        ("/**:\n  ros__parameters: 5\n", "ros__parameters"),
        ("/**: 5\n", "ros__parameters"),
        ("/**:\n  ros__parameters:\n    laser_fow: 1.5\n", "unknown parameter 'laser_fow'; did you mean 'laser_fov'"),
        ("laser_scanner_node:\n  ros__parameters: {}\n", "did you mean 'laser_scanner_simulator_node'"),
        ("mobile_robot_simulator_node:\n  ros__parameters:\n    laser_fov: 1.5\n", "unknown parameter 'laser_fov'"),
        ("a: [1\n", "not valid YAML: line 2"),
        ("a: b: c\n", "not valid YAML: line 1, column 5"),
        ("a: \x07\n", "a must contain a mapping ros__parameters"),
        ("? [1, 2]\n: 5\n", "line 1: a key must be a single word"),
        ("/**:\n  ros__parameters:\n    5: 1\n", "unknown parameter '5'"),
    ],
)
def test_invalid_files_are_rejected(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        read_file(written(tmp_path, text))
    assert words in str(caught.value)


def test_the_error_for_a_binary_file_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "map.pgm"
    path.write_bytes(b"P5\n\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"map\.pgm"):
        read_file(path)


def test_a_missing_file_and_a_folder_are_os_errors(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="nowhere"):
        read_file(tmp_path / "nowhere.yaml")
    with pytest.raises(OSError, match=str(tmp_path)):
        read_file(tmp_path)


def test_a_value_under_a_node_name_is_for_that_node_only(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        "mobile_robot_simulator_node:\n  ros__parameters: {base_link_frame: base_footprint}\n"
        "laser_scanner_simulator_node:\n  ros__parameters: {seed: 5}\n",
    )
    values = read_file(path)
    assert for_node(RobotParameters, values).base_link_frame == "base_footprint"
    path = written(
        tmp_path,
        "mobile_robot_simulator_node:\n  ros__parameters: {map_frame_id: world}\n"
        "laser_scanner_simulator_node:\n  ros__parameters: {map_frame_id: map}\n",
    )
    values = read_file(path)
    assert for_node(RobotParameters, values).map_frame_id == "world"
    assert for_node(LaserParameters, values).map_frame_id == "map"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("publish_rate:=20", ("publish_rate", 20)),
        ("publish_rate:=2e1", ("publish_rate", 20.0)),
        ("publish_rate:=1e7", ("publish_rate", 1e7)),
        ("laser_fov:=1.5", ("laser_fov", 1.5)),
        ("publish_map_transform:=true", ("publish_map_transform", True)),
        ("laser_topic:=/front/scan", ("laser_topic", "/front/scan")),
        ("laser_mount:=[0.1, 0.0, 0.0]", ("laser_mount", [0.1, 0.0, 0.0])),
        ("no_return:=max", ("no_return", "max")),
        ("laser_topic:=a:=b", ("laser_topic", "a:=b")),
    ],
)
def test_assignments_are_read(text: str, expected: tuple[str, Any]) -> None:
    assert read_assignment(text) == expected


def test_what_the_nodes_on_ros_take_is_taken(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        "/**:\n  ros__parameters: {use_sim_time: true, qos_overrides./tf.publisher.depth: 5}\n"
        "controller_server:\n  ros__parameters: {frequency: 20.0, FollowPath: {plugin: x}}\n"
        "robot1:\n  mobile_robot_simulator_node:\n    ros__parameters: {publish_rate: 1e2}\n"
        "/robot1/laser_scanner_simulator_node:\n  ros__parameters: {scan_range_max: 12, scan_use_inf: false}\n",
    )
    values = translated(read_file(path))
    assert for_node(RobotParameters, values).publish_rate == 100.0
    laser = for_node(LaserParameters, values)
    assert laser.laser_max_range == 12.0 and laser.no_return == "below_max"


def test_two_sections_of_one_node_and_a_misspelt_node_are_errors(tmp_path: Path) -> None:
    section = "laser_scanner_simulator_node:\n    ros__parameters: {seed: 1}\n"
    with pytest.raises(ValueError, match="there must be one section for laser_scanner_simulator_node, got '/a/laser"):
        read_file(written(tmp_path, f"a:\n  {section}b:\n  {section}"))
    with pytest.raises(ValueError, match="unknown node 'laser_scaner_simulator_node'; did you mean"):
        read_file(written(tmp_path, section.replace("scanner", "scaner")))
    with pytest.raises(ValueError, match="must have a section for mobile_robot_simulator_node"):
        read_file(written(tmp_path, "amcl:\n  ros__parameters: {alpha1: 0.1}\n"))


def test_deep_nesting_is_an_error(tmp_path: Path) -> None:
    for text in ("[" * 100_000, "{a: " * 100_000):
        with pytest.raises(ValueError, match="inside at most 50 others"):
            read_file(written(tmp_path, text))
    with pytest.raises(ValueError, match="inside at most 50 others"):
        read_assignment("laser_mount:=" + "[" * 100_000)


def test_numbers_that_yaml_reads_as_text_are_accepted() -> None:
    name, value = read_assignment("publish_rate:=2e1")
    assert RobotParameters.checked({name: value}).publish_rate == 20.0


@pytest.mark.parametrize("text", ["publish_rate", "publish_rate=20", ":=20", "publish_rate: 20", ""])
def test_text_that_is_not_an_assignment_is_rejected(text: str) -> None:
    with pytest.raises(ValueError, match="name:=value, got"):
        read_assignment(text)


def test_a_value_that_is_not_yaml_is_rejected() -> None:
    with pytest.raises(ValueError, match="laser_mount must be YAML"):
        read_assignment("laser_mount:=[1, 2")


def test_a_node_whose_name_begins_like_a_name_of_ours_is_another_node(tmp_path: Path) -> None:
    text = "laser:\n  ros__parameters: {port: 1}\nlaser_scanner_simulator_node:\n  ros__parameters: {laser_fov: 1.5}\n"
    assert list(read_back(tmp_path, text).values()) == [1.5]


def read_back(folder: Path, text: str) -> dict[str, Any]:
    return read_file(written(folder, text))


def test_the_file_of_all_parameters_reads_back_with_descriptions(tmp_path: Path) -> None:
    text = to_yaml()
    values = read_back(tmp_path, text)
    for model in NODES:
        assert for_node(model, values) == model()
        section = text.partition(f"{model.node_name}:")[2].splitlines()
        for name, info in model.model_fields.items():
            assert next(line for line in section if line.strip().startswith(f"{name}:")).endswith(f"# {info.description}")
    assert list(yaml.safe_load(text)) == [model.node_name for model in NODES]


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
    read = read_back(tmp_path_factory.mktemp("parameters"), to_yaml(values))
    for model in NODES:
        assert for_node(model, read) == for_node(model, values)


def test_unknown_values_cannot_be_written() -> None:
    with pytest.raises(ValueError, match="laser_fow"):
        to_yaml({"laser_fow": 1.0})


def test_an_unknown_name_in_an_assignment_suggests_the_nearest() -> None:
    with pytest.raises(ValueError, match="unknown parameter 'publish_rat'; did you mean 'publish_rate'"):
        read_assignment("publish_rat:=1")


FAULT = "Drop('/scan', probability=0.1)"


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("/**:\n  ros__parameters: {publish_rate: 20.0}\n", ()),
        (f'/**:\n  ros__parameters:\n    faults: ["{FAULT}", "Slip(0.1)"]\n', (FAULT, "Slip(0.1)")),
        (f'here:\n  world_server:\n    ros__parameters:\n      faults: ["{FAULT}"]\n', (FAULT,)),
        (
            f'/**:\n  ros__parameters:\n    faults: [a]\nworld_server:\n  ros__parameters:\n    faults: ["{FAULT}"]\n',
            (FAULT,),
        ),
    ],
)
def test_a_file_has_faults_for_all_nodes_or_for_the_world(tmp_path: Path, text: str, faults: tuple[str, ...]) -> None:
    assert read_fault_texts(written(tmp_path, text)) == faults


def test_faults_are_no_parameter_of_a_node(tmp_path: Path) -> None:
    path = written(tmp_path, "/**:\n  ros__parameters: {publish_rate: 20.0, faults: [a]}\n")
    assert read_file(path) == {"publish_rate": 20.0}


@pytest.mark.parametrize("value", ["a", "[1]", "[[a]]"])
def test_faults_must_be_a_list_of_texts(tmp_path: Path, value: str) -> None:
    path = written(tmp_path, f"/**:\n  ros__parameters: {{faults: {value}}}\n")
    with pytest.raises(ValueError, match="faults must be a list of texts such as") as raised:
        read_fault_texts(path)
    assert str(raised.value).startswith(f"{path}: ")
