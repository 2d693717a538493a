"""The command parameters."""

import yaml


def test_printed_parameters_can_be_read_again(command, room, tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text(
        command(
            "parameters", "-p", "laser_beam_count:=17", "-p", "laser_mount:=[0.1, 0.0, 1.5]", "-p", "laser_frame_id:=laser"
        ).stdout
    )
    again = command("parameters", "--ros-args", "--params-file", file)
    assert again.stdout == file.read_text()
    content = yaml.safe_load(again.stdout)
    assert content["laser_scanner_simulator_node"]["ros__parameters"]["laser_beam_count"] == 17
