"""What a page is made of, and its way into HTML."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup


@dataclass(frozen=True, kw_only=True)
class Picture:
    """An image (a data address), its caption, and a text for those who cannot see it."""

    source: str
    caption: str
    alt: str


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows of text; the first column is a name, the others stand right if ``numbers``."""

    head: list[str] = field(default_factory=list)
    rows: list[list[str]]
    numbers: bool = True
    note: str = ""


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading and what stands under it; ``columns`` pictures side by side.

    ``viewer`` is the JSON of a turnable view (``coupling.report.viewer``); one section has it.
    """

    title: str
    text: str = ""
    tables: list[Table] = field(default_factory=list)
    pictures: list[Picture] = field(default_factory=list)
    columns: int = 2
    scale: Picture | None = None
    source: str = ""
    viewer: str = ""


@dataclass(frozen=True, kw_only=True)
class Page:
    """A report: ``verdict`` is the sentence at the top, ``alarm`` what went wrong."""

    title: str
    subtitle: str
    verdict: str
    explanation: str
    alarm: str = ""
    figures: list[tuple[str, str, str]] = field(default_factory=list)
    sections: list[Section]
    footer: str


def html(page: Page) -> str:
    """The page as one self-contained HTML text."""
    environment = Environment(
        loader=PackageLoader("coupling.report", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    scripts = [_script(name) for name in ("three.min.js", "tank.js", "viewer.js")]
    turnable = any(section.viewer for section in page.sections)
    template = environment.get_template("report.html")
    return template.render(page=page, scripts=scripts if turnable else [], data=_data)


def _script(name: str) -> Markup:
    """A script of the turnable view, which is no template."""
    return Markup(files("coupling.report").joinpath("webgl", name).read_text(encoding="utf-8"))


def _data(json_text: str) -> Markup:
    """JSON inside a script's tags, which no text in it can close."""
    return Markup(json_text.replace("<", "\\u003c"))


def number(value: float | None, unit: str = "", digits: int = 3) -> str:
    """Figure to ``digits`` significant digits, with a thin space and its unit; a dash for None."""
    if value is None:
        return "–"
    text = f"{value:.{digits}g}"
    if 1.0 <= abs(value) < 1e5:
        text = f"{float(text):g}"
    if "e" in text:
        mantissa, _, exponent = text.partition("e")
        raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        text = f"{mantissa} × 10{raised}" if mantissa != "1" else f"10{raised}"
    text = text.replace("-", "−")
    return f"{text}\u202f{unit}" if unit else text


def ratio(value: float | None) -> str:
    """A ratio of something to what may vanish: beyond a million it says no more than that."""
    return number(value) if value is None or value <= 1e6 else "> 10⁶"


def percent(value: float | None) -> str:
    """A fraction as a percentage of two significant digits; a dash for None."""
    if value is None:
        return "–"
    size = abs(100.0 * value)
    if 0.995 <= size < 9.95:
        return f"{100.0 * value:.1f}\u202f%".replace("-", "−")
    if size >= 9.95:
        return f"{100.0 * value:.0f}\u202f%".replace("-", "−")
    return number(100.0 * value, "%", 2) if size >= 0.01 or size == 0.0 else "<\u202f0.01\u202f%"
