"""Imports point one way: cloth <- coupling, and within coupling from the scene to the command."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("cloth", "coupling")

COMPILER = "cloth.compiled"  # and its cache, which know of no cloth

# From a part to what it must never import; a part is a module or a package, with all below it.
FORBIDDEN = [
    ("cloth", "coupling"),
    ("cloth", "foam_cases"),
    ("coupling.fluids", "cloth"),
    ("coupling.foam", "cloth"),
    ("coupling.foam", "coupling.structure.diaphragm"),
    ("coupling.fluids", "coupling.structure.diaphragm"),
    ("coupling.metrics", "coupling.run.driver"),
    ("coupling.report", "coupling.run.driver"),
    ("coupling.metrics", "coupling.run.participants"),
    ("coupling.report", "coupling.run.participants"),
    ("coupling.metrics", "coupling.report"),
    ("coupling.store.results", "coupling.metrics"),
    ("coupling.run.driver", "coupling.campaign.study"),
    ("coupling.run.participants", "coupling.run.driver"),
    ("coupling.run.participants", "coupling.store.results"),
    ("coupling.ports", "cloth"),
    ("coupling.store.run_record", "cloth"),
    *[
        (early, late)
        for early in (
            "coupling.scene.scene",
            "coupling.motion.kinds",
            "coupling.ports",
            "coupling.store.run_record",
            "coupling.schemes",
        )
        for late in (
            "coupling.run.driver",
            "coupling.run.participants",
            "coupling.fluids",
            "coupling.foam",
            "coupling.store.results",
        )
    ],
    *[
        (part, "coupling.cli.main")
        for part in (
            "coupling.run.driver",
            "coupling.campaign.study",
            "coupling.report",
            "coupling.verify",
        )
    ],
]


def module_name(file: Path) -> str:
    parts = file.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(file): file for package in PACKAGES for file in (ROOT / package).rglob("*.py")}


def imported(name: str, *, at_import: bool = False) -> Iterator[str]:
    """Our modules that ``name`` imports; with ``at_import`` only those of its top level."""
    tree = ast.parse(FILES[name].read_text())
    for node in tree.body if at_import else ast.walk(tree):
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name}: relative import"
            found = [node.module or ""]
            found += [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        yield from (module for module in found if module.split(".")[0] in (*PACKAGES, "foam_cases"))


def within(module: str, part: str) -> bool:
    return module == part or module.startswith(f"{part}.")


def reached(start: str) -> set[str]:
    """All modules that importing ``start``, and calling what it holds, brings in."""
    seen: set[str] = set()
    waiting = [start]
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        if name in FILES:
            waiting += imported(name)
    return seen


@pytest.mark.parametrize(("part", "never"), FORBIDDEN)
def test_imports_point_one_way(part: str, never: str):
    offenders = [
        f"{name} imports {module}"
        for name in FILES
        if within(name, part)
        for module in imported(name)
        if within(module, never) and not module.startswith(COMPILER)
    ]
    assert not offenders


@pytest.mark.parametrize("part", ["coupling.metrics", "coupling.report"])
def test_reports_never_reach_the_driver_even_through_others(part: str):
    for name in FILES:
        if within(name, part):
            assert "coupling.run.driver" not in reached(name), name


def test_fluids_never_reach_the_cloth_beyond_the_scene():
    """The scene asks for rubbers and the thesis' grid; but for the compiler, nothing else comes."""
    asked = {"cloth", "cloth.arrays", "cloth.material", "cloth.thesis.grid"}
    for name in FILES:
        if within(name, "coupling.fluids") or within(name, "coupling.foam"):
            cloth = {module for module in reached(name) & set(FILES) if within(module, "cloth")}
            assert {module for module in cloth if not module.startswith(COMPILER)} <= asked, name


def test_no_module_imports_itself_in_a_circle():
    graph = {
        name: {module for module in imported(name, at_import=True) if module in FILES} - {name}
        for name in FILES
    }
    # ``from package import name`` needs the package; a package that lists its parts is no circle.
    done: set[str] = set()

    def visit(name: str, path: tuple[str, ...]) -> None:
        assert name not in path, " -> ".join((*path[path.index(name) :], name))
        if name not in done:
            for module in graph[name]:
                visit(module, (*path, name))
            done.add(name)

    for name in graph:
        visit(name, ())


def test_the_walk_sees_imports_at_all():
    assert "coupling.scene.scene" in set(imported("coupling.motion.kinds"))
    assert "cloth.material" in set(imported("coupling.scene.diaphragm"))
    assert "coupling.run.driver" in set(imported("coupling.cli.main"))  # inside a function
    assert "coupling.run.driver" not in set(imported("coupling.cli.main", at_import=True))


def test_only_one_module_compiles():
    """What is kept on the disk is checked when it is read: by that module alone."""
    for package in ("cloth", "coupling"):
        for path in (ROOT / package).rglob("*.py"):
            if path.parent.name != "cloth" or not path.name.startswith("compiled"):
                assert "numba.njit" not in path.read_text(encoding="utf-8"), path
