"""What the README and the pages of docs/ show runs, and what they name is there.

The blocks of a page run from top to bottom in one folder and one namespace. Blocks of TOML and
Python with a title are written to the file of that name, blocks of sh are commands that succeed.
``<!-- needs openfoam -->`` above a block says so.
"""

from __future__ import annotations

import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.fluids import FLUIDS
from coupling.motion import MOTIONS
from coupling.schemes import SCHEMES
from coupling.verify import CASES

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs" / "pages").rglob("*.md"))]
_BLOCK = re.compile(
    r'(?P<needs><!-- needs openfoam -->\n)?```(?P<kind>\w+)(?: title="(?P<title>[^"]+)")?\n'
    r"(?P<text>.*?)\n```",
    re.DOTALL,
)
_LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
_PATH = re.compile(r"`((?:coupling|cloth|foam_cases|tests|docs)/[\w./-]+|\.ci/\w+)`")
# The two commands of the README: they are what runs these tests.
SET_UP = "bash .ci/setup && .venv/bin/"


class Block(NamedTuple):
    """A block of code; ``line`` of its page."""

    kind: str
    title: str | None
    text: str
    line: int
    needs_openfoam: bool


def blocks_of(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    return [
        Block(
            found["kind"],
            found["title"],
            found["text"],
            text.count("\n", 0, found.start("text")) + 1,
            found["needs"] is not None,
        )
        for found in _BLOCK.finditer(text)
    ]


def with_code() -> Iterator[Any]:
    for page in PAGES:
        blocks = blocks_of(page)
        if any(block.kind in ("python", "sh") for block in blocks):
            marks = [pytest.mark.openfoam] if any(one.needs_openfoam for one in blocks) else []
            yield pytest.param(page, id=page.stem, marks=marks)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with the cases; lists are left as they were."""
    (tmp_path / "foam_cases").symlink_to(ROOT / "foam_cases")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for registry in (FLUIDS, SCHEMES, MOTIONS, CASES):
        monkeypatch.setattr(registry, "_places", dict(registry._places))
    return tmp_path


@pytest.mark.parametrize("page", list(with_code()))
def test_the_blocks_of_a_page_run(page: Path, folder: Path) -> None:
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks_of(page):
        if block.title is not None:
            file = folder / block.title
            file.parent.mkdir(exist_ok=True)
            file.write_text(block.text + "\n")
        elif block.kind == "python":
            # the line numbers of a traceback are those of the page
            exec(compile("\n" * block.line + block.text, str(page), "exec"), names)
        elif block.kind == "sh" and not block.text.startswith(SET_UP):
            for line in block.text.splitlines():
                command, *words = shlex.split(line)
                assert command == "edt"
                done = CliRunner().invoke(app, words)
                assert done.exit_code == 0, f"{line}\n{done.output}"
        if block.kind == "toml":
            tomllib.loads(block.text)


def test_every_block_says_what_it_is() -> None:
    for page in PAGES:
        fences = re.findall(r"^```(\w*)", page.read_text(encoding="utf-8"), re.MULTILINE)
        opened = fences[::2]
        assert set(opened) <= {"python", "sh", "toml", "text"}, page
        assert len(opened) == len(blocks_of(page)), page


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_files_that_a_page_names_are_there(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for place in _PATH.findall(text):
        assert (ROOT / place).exists(), f"{page}: {place}"
    if page == README:  # the links of the pages are checked when they are built
        for place in _LINK.findall(text):
            assert (ROOT / place).exists(), place


def test_the_readme_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 120


def test_the_message_that_is_shown_is_the_one_that_is_given(folder: Path) -> None:
    page = ROOT / "docs" / "pages" / "tutorials" / "engineer.md"
    scene, shown = (b for b in blocks_of(page) if b.title or "must lie in" in b.text)
    (folder / "sway").mkdir()
    wrong = scene.text.replace("fill_fraction = 0.8", "fill_fraction = 1.4")
    (folder / "sway" / "scene.toml").write_text(wrong)
    assert CliRunner().invoke(app, ["check", "sway"]).output.strip() == shown.text
