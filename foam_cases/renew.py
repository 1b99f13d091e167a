"""Makes the studies and sweeps of the cases again, and says what has changed.

    python foam_cases/renew.py [CASE ...] [--list]

Runs the commands that the cases' own READMEs give, those blocks that hold an `edt study`, an `edt
sweep` or a script of the case, in `runs/renewed/COMMIT`: stopped and started again on the same
commit it goes on, since studies and sweeps do. What a study found is kept as `figures.json` beside
its case; the tables that a case keeps are replaced by its own commands. Both are held against what
stood there before. Hours for all cases: start it in the background.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
FIGURES = "figures.json"
_BLOCK = re.compile(r"^```sh\n(.*?)^```", re.MULTILINE | re.DOTALL)
_WANTED = re.compile(r"edt (study|sweep) |python foam_cases/")
_OUTPUT = re.compile(r" -o (\S+)")
_TIMED = re.compile(r"wall|speed|seconds")  # heads of what differs from run to run


def blocks(readme: str) -> list[str]:
    """Return the blocks of commands in a case's ``readme`` that make its studies and tables."""
    return [block for block in _BLOCK.findall(readme) if _WANTED.search(block)]


def figures(study: Mapping[str, Any]) -> dict[str, Any]:
    """What is kept of a ``study``: errors by model and figure, their bars, what was said."""
    errors = {name: row["error"] for name, row in study["models"].items() if row.get("error")}
    record = study.get("record")
    return {
        "reference": study["reference"], "errors": errors, "uncertainty": study["uncertainty"],
        "bernoulli": study["bernoulli"], "sources": study["sources"], "verdict": study["verdict"],
        "record": record and {key: record[key] for key in ("error", "uncertainty", "verdict")},
    }  # fmt: skip


def changes(before: Any, after: Any, place: str = "") -> Iterator[str]:
    """A line for every number or text that differs by more than 1 in 1000, by its ``place``."""
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        for key in {**before, **after}:
            yield from changes(before.get(key), after.get(key), f"{place}.{key}".lstrip("."))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for index, pair in enumerate(zip(before, after, strict=True)):
            yield from changes(*pair, f"{place}[{index}]")
    elif isinstance(before, float) and isinstance(after, float):
        if not math.isclose(before, after, rel_tol=1e-3, abs_tol=1e-12):
            yield f"{place}: {before:.4g}, now {after:.4g}"
    elif before != after:
        yield f"{place}: {before}, now {after}"


def table(path: Path) -> list[dict[str, Any]]:
    """Rows of a CSV table, numbers as such, without the times that they took."""
    with path.open(encoding="utf-8", newline="") as file:
        return [
            {key: _number(value) for key, value in row.items() if not _TIMED.search(key)}
            for row in csv.DictReader(file)
        ]


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def renew(case: Path, folder: Path) -> list[str]:
    """Run the commands of a ``case`` in ``folder``; return what has changed, a line each.

    Raises ``CalledProcessError`` where a command fails.
    """
    before = _kept(case)
    found = {}
    for block in blocks((case / "README.md").read_text(encoding="utf-8")):
        # The commands write to runs/ and read foam_cases/ where they are called.
        subprocess.run(["bash", "-eo", "pipefail", "-c", block], cwd=folder, check=True)
        for place in _OUTPUT.findall(block):
            study = folder / place / "study.json"
            if study.is_file():
                found[place] = figures(json.loads(study.read_text(encoding="utf-8")))
    if found:
        (case / FIGURES).write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return list(changes(before, _kept(case)))


def _kept(case: Path) -> dict[str, Any]:
    """What stands beside a ``case``: its tables, and the figures of its studies."""
    kept: dict[str, Any] = {path.name: table(path) for path in sorted(case.glob("*.csv"))}
    if (case / FIGURES).is_file():
        kept[FIGURES] = json.loads((case / FIGURES).read_text(encoding="utf-8"))
    return kept


def cases() -> list[Path]:
    """The cases whose READMEs have something to renew."""
    readmes = sorted(HERE.glob("*/README.md"))
    return [path.parent for path in readmes if blocks(path.read_text(encoding="utf-8"))]


def scratch() -> Path:
    """The folder in which this commit's commands are called, with what they read linked there."""
    commit = ["git", "rev-parse", "--short", "HEAD"]
    name = subprocess.run(commit, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    folder = ROOT / "runs" / "renewed" / name.strip()
    folder.mkdir(parents=True, exist_ok=True)
    for name in (".venv", "foam_cases", "coupling"):
        if not (folder / name).exists():
            (folder / name).symlink_to(ROOT / name)
    return folder


def main(given: Sequence[str] | None = None) -> int:
    """Renew the cases asked for, all of them without any; 1 where a command failed."""
    known = {case.name: case for case in cases()}
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("case", nargs="*", choices=[[], *known], help="all, if left out")
    parser.add_argument("--list", action="store_true", help="print the commands alone")
    asked = parser.parse_args(given)
    failed = False
    for name in asked.case or known:
        if asked.list:
            commands = blocks((known[name] / "README.md").read_text(encoding="utf-8"))
            print(f"# {name}", *commands, sep="\n")
            continue
        try:
            lines = renew(known[name], scratch())
        except subprocess.CalledProcessError as error:
            failed = True
            lines = [f"failed with status {error.returncode}: {error.cmd[-1].strip()}"]
        print(f"{name}:", *(f"  {line}" for line in lines or ["nothing changed"]), sep="\n")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
