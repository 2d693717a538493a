"""readme: the examples of the README print the output that it shows."""

import contextlib
import io
import re
from pathlib import Path
from typing import Any

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_examples_print_the_shown_output() -> None:
    names: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for code in blocks("python"):
            exec(code, names)
    assert printed.getvalue() == blocks("text")[0]
    assert names["ranges"].shape == (100, 541)
