"""Writes the docstrings of the compiled core into its stub, where editors look for them.

Each docstring is written once, in Rust. A test fails if the stub differs from what this script writes.
"""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import mobile_robot_simulator._core as core

STUB = Path(__file__).parents[2] / "python" / "mobile_robot_simulator" / "_core.pyi"


def with_docstrings(stub: str) -> str:
    """Returns the text of a stub with the docstring of each public class, method and function."""
    lines = stub.splitlines()
    found: list[tuple[ast.ClassDef | ast.FunctionDef, str]] = []
    for node in ast.parse(stub).body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            owner = getattr(core, node.name)
            found.append((node, inspect.cleandoc(owner.__doc__)))
            for member in node.body if isinstance(node, ast.ClassDef) else ():
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                    found.append((member, inspect.cleandoc(getattr(owner, member.name).__doc__)))
    for node, text in sorted(found, key=lambda pair: pair[0].lineno, reverse=True):
        first = node.body[0]
        indent = " " * (node.col_offset + 4)
        lines_of_text = [*text.split("\n"), '"""'] if "\n" in text else [f'{text}"""']
        lines_of_text[0] = f'"""{lines_of_text[0]}'
        docstring = [f"{indent}{line}".rstrip() for line in lines_of_text]
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
            lines[first.lineno - 1 : first.end_lineno] = docstring
        elif isinstance(node, ast.ClassDef):
            above = first.lineno - 1 - len(getattr(first, "decorator_list", ()))
            lines[above:above] = [*docstring, ""]
        else:
            assert lines[first.lineno - 1].endswith(": ...")
            lines[first.lineno - 1 : first.end_lineno] = [lines[first.lineno - 1].removesuffix(" ..."), *docstring]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    STUB.write_text(with_docstrings(STUB.read_text(encoding="utf-8")), encoding="utf-8")
