"""What the pages take from the code: keys, verbs, the drawing of the folders, equations, pictures.

A hook of MkDocs. A page has ``<!-- scene keys -->``, ``<!-- verbs -->``, ``<!-- folders -->`` or
``<!-- datasets -->`` where the text goes, and LaTeX between dollars, which becomes MathML, so that
no script is fetched from elsewhere.
"""

from __future__ import annotations

import ast
import html
import inspect
import re
import tomllib
from itertools import groupby
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
PICTURES = {
    "pictures/sway.png": "foam_cases/pad_sway_coarse/sway.png",
    "pictures/errors.png": "foam_cases/sway_map/errors.png",
    "pictures/folds.png": "tests/benchmarks/folds.png",
}
_FENCED = re.compile(r"(```.*?```|`[^`\n]+`)", re.DOTALL)


def on_files(files: Files, config: Any) -> Files:
    """Add the pictures that stand beside what draws them."""
    for place, source in PICTURES.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / source)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Fill in what comes from the code."""
    for name, text in TEXTS.items():
        if f"<!-- {name} -->" in markdown:
            markdown = markdown.replace(f"<!-- {name} -->", text())
    parts = _FENCED.split(markdown)
    return "".join(part if index % 2 else _mathml(part) for index, part in enumerate(parts))


def _mathml(text: str) -> str:
    text = re.sub(
        r"\$\$(.+?)\$\$",
        lambda found: "\n" + convert(found[1].strip(), display="block") + "\n",
        text,
        flags=re.DOTALL,
    )
    text = re.sub(r"\bp\*", "p&#42;", text)  # not the beginning of an emphasis
    return re.sub(r"\$([^$]+)\$", lambda found: f"<span>{convert(found[1])}</span>", text)


def scene_keys() -> str:
    """A table for each section: key, unit, values, default, meaning."""
    from coupling.scene.reference import keys, section_of

    lines: list[str] = []
    for section, found in groupby(keys(), key=lambda key: key.section):
        if section:
            said = inspect.getdoc(section_of(section)) or ""
            lines += [f"\n## [{section}]\n", said.replace("``", "`"), ""]
        lines += ["| key | unit | value | default | meaning |", "|---|---|---|---|---|"]
        for key in found:
            default = f"`{key.default}`" if key.default else ("needed" if key.required else "")
            meaning = _cell(key.meaning)
            if key.instead:
                meaning += f"; or, in its place, {_cell(key.instead)}"
            cells = (f"`{key.name}`", _cell(key.unit), _cell(key.values), default, meaning)
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def verbs() -> str:
    """Each verb of the command with its arguments and options, as ``--help`` has them."""
    import typer

    from coupling.cli.main import app

    lines: list[str] = []
    for name, verb in typer.main.get_command(app).commands.items():  # type: ignore[attr-defined]
        context = typer.Context(verb, info_name=f"edt {name}")
        usage = " ".join(verb.collect_usage_pieces(context))
        lines += [f"\n## edt {name}\n", f"`edt {name} {usage}`\n", inspect.cleandoc(verb.help), ""]
        rows = [row for one in verb.params if (row := one.get_help_record(context))]
        if rows:
            lines += ["| option | does |", "|---|---|"]
            lines += [f"| `{option}` | {_cell(said)} |" for option, said in rows]
    return "\n".join(lines)


def datasets() -> str:
    """The datasets of ``results.h5``: shape, unit, name in ``Results``."""
    from coupling.store.results_layout import FIELDS, METRIC_UNITS, dims_of

    sizes = {"node": "n", "triangle": "m", "axis": "3"}
    lines = ["| dataset | shape | unit | in `Results` |", "|---|---|---|---|"]
    lines += [
        "| `diaphragm/triangles` | (m, 3) | - | `triangles` |",
        "| `diaphragm/reference` | (n, 3) | m | `reference` |",
    ]
    for dataset, (name, unit) in FIELDS.items():
        shape = ", ".join(["T", *(sizes[dimension] for dimension in dims_of(name))])
        comma = "," if shape == "T" else ""
        lines.append(f"| `{dataset}` | ({shape}{comma}) | {unit} | `{name}` |")
    lines += [
        f'| `metrics/{name}` | (T,) | {unit} | `metrics["{name}"]` |'
        for name, unit in METRIC_UNITS.items()
    ]
    return "\n".join(lines)


def folders() -> str:
    """A drawing of the folders, from the contract that the imports are held against."""
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = config["tool"]["importlinter"]["contracts"]
    layers = next(c["layers"] for c in contracts if c.get("containers") == ["coupling"])
    width, height, gap = 760, 34, 8
    rows = [layer.split(" | ") for layer in layers] + [["cloth"]]
    shapes = []
    for row, names in enumerate(rows):
        top = row * (height + gap)
        part = (width - 60 - gap * (len(names) - 1)) / len(names)
        for place, name in enumerate(names):
            left = 60 + place * (part + gap)
            said = html.escape(_first_sentence(name, 92 // len(names)))
            colour = "#fff4e5" if name == "cloth" else "#eaf2f8"
            shapes.append(
                f'<rect x="{left:.0f}" y="{top}" width="{part:.0f}" height="{height}" rx="4" '
                f'fill="{colour}" stroke="#6b757d"/>'
                f'<text x="{left + 8:.0f}" y="{top + 14}" font-weight="bold">{name}</text>'
                f'<text x="{left + 8:.0f}" y="{top + 28}" font-size="10">{said}</text>'
            )
    bottom = len(rows) * (height + gap)
    arrow = (
        f'<line x1="25" y1="6" x2="25" y2="{bottom - 20}" stroke="#0072B2" stroke-width="2"/>'
        f'<path d="M18 {bottom - 24} L25 {bottom - 10} L32 {bottom - 24} Z" fill="#0072B2"/>'
        f'<text x="14" y="{bottom / 2:.0f}" transform="rotate(-90 14 {bottom / 2:.0f})" '
        'text-anchor="middle">may import</text>'
    )
    return (
        f'<svg viewBox="0 0 {width} {bottom}" role="img" font-family="sans-serif" font-size="12" '
        'fill="#1c2329" style="max-width:100%;background:#fff">'
        f"<title>The folders, each of which imports only from those below it</title>"
        f"{arrow}{''.join(shapes)}</svg>\n"
    )


def _first_sentence(name: str, most: int) -> str:
    place = ROOT / "cloth" if name == "cloth" else ROOT / "coupling" / name
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    said = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    first = said.partition("\n\n")[0].replace("\n", " ").replace("``", "")
    return first if len(first) <= most else first[: most - 1].rpartition(" ")[0] + " …"


def _cell(text: str) -> str:
    """Text that a cell of a table can hold."""
    escaped = html.escape(text, quote=False).replace("|", "&#124;").replace("*", "&#42;")
    return escaped.replace("_", "&#95;")


TEXTS = {"scene keys": scene_keys, "verbs": verbs, "datasets": datasets, "folders": folders}
