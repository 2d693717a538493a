"""documents: every snippet of the README and the documentation runs and prints the output that the page shows.

The snippets of a page run in order, in one empty folder:

- `python` blocks share one namespace. pytest also runs the blocks that define tests.
- a `text` block must equal the output of the block before it.
- `sh` blocks run in bash and must succeed.
- `<!-- skip: next "reason" -->` before a block skips it and gives the reason.

Other blocks (`console`, `yaml`, ...) are not run.
"""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path
from unittest import SkipTest

import pytest
from sybil import Example, Sybil
from sybil.evaluators.python import PythonEvaluator
from sybil.parsers.markdown import CodeBlockParser, SkipParser

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "python" / "mobile_robot_simulator"
GENERATED = ("command_line.md", "parameters.md")
BUILT = {"demo/", "dist/", "site/"}
"""Folders that the repository does not have before a build."""
PAGES = [ROOT / "README.md", *(path for path in sorted((ROOT / "docs").rglob("*.md")) if path.name not in GENERATED)]


class Page:
    """Evaluates the snippets of one page."""

    def __init__(self) -> None:
        self._run = PythonEvaluator()
        self._tests = 0
        self.printed: str | None = None

    def python(self, example: Example) -> None:
        printed = io.StringIO()
        with redirect_stdout(printed):
            self._run(example)
        self.printed = printed.getvalue()
        if re.search(r"^def test_", example.parsed, re.MULTILINE):
            self._tests += 1
            file = Path(f"test_snippet_{self._tests}.py")
            file.write_text(example.parsed, encoding="utf-8")
            self._call([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(file)])

    def text(self, example: Example) -> None:
        assert self.printed is not None, "a text block must follow the snippet that prints it"
        assert example.parsed == self.printed

    def sh(self, example: Example) -> None:
        self.printed = self._call(["bash", "-euo", "pipefail", "-c", example.parsed])

    @staticmethod
    def _call(command: list[str]) -> str:
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            command,
            env={**os.environ, "PATH": path, "COLUMNS": "120"},
            capture_output=True,
            text=True,
            timeout=300,
            stdin=subprocess.DEVNULL,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_snippets_run_and_print_the_shown_output(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = Page()
    parsers = [CodeBlockParser(language, getattr(page, language)) for language in ("python", "text", "sh")]
    document = Sybil([*parsers, SkipParser()]).parse(path)
    monkeypatch.chdir(tmp_path)
    for example in document.examples():
        try:
            example.evaluate()
        except SkipTest as reason:
            assert len(str(reason)) > 8, f"line {example.line}: give a reason for skipping the snippet"
            page.printed = None


def test_generated_pages_are_up_to_date() -> None:
    script = ROOT / "docs" / "tools" / "generate_pages.py"
    code = f"import runpy; print(all(p.read_text() == t for p, t in runpy.run_path({str(script)!r})['pages']().items()))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.strip() == "True", "the generated pages are out of date; run docs/tools/generate_pages.py"


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_files_that_a_page_names_exist(page: str) -> None:
    """Files are named from the root of the repository on, or from the folder of the package."""
    text = (ROOT / page).read_text(encoding="utf-8")
    named = set(re.findall(r"`([\w.-]*(?:/[\w.-]+)*(?:\.(?:rs|pyi?)|/[\w-]+\.\w+|/))`", text)) - BUILT
    assert len(named) > 30
    assert not [name for name in sorted(named) if not (ROOT / name).exists() and not (PACKAGE / name).exists()]
