"""The command `parameters`: all parameters as YAML."""

from __future__ import annotations

from .options import Assignments, ParamsFile, RosArgs, read_values


def parameters(param: Assignments = None, params_file: ParamsFile = None, ros_args: RosArgs = False) -> None:
    """Print all parameters and their descriptions, as a YAML file for --params-file."""
    from ..parameter_files import to_yaml

    print(to_yaml(read_values(param, params_file)), end="")
