"""Imports point one way: cloth <- coupling, and within coupling from the ports to the command."""

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from coupling.fluids import FLUIDS

ROOT = Path(__file__).parent.parent
PACKAGES = ("cloth", "coupling")


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


def lint(config: Path) -> subprocess.CompletedProcess[str]:
    """Hold the imports here against the contracts of ``config``."""
    return subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache", config],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_imports_point_one_way():
    """The contracts stand in ``pyproject.toml``."""
    done = lint(ROOT / "pyproject.toml")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (('"motion",\n    "scene",', '"scene",\n    "motion",'), "coupling.motion.sine ->"),
        (('    "store",\n', ""), "coupling.store"),  # as a folder that nobody gave a place
        (('"coupling.scene.diaphragm -> cloth.material",', ""), "coupling.scene.diaphragm ->"),
    ],
)
def test_a_contract_that_does_not_hold_is_seen(tmp_path: Path, wrong: tuple[str, str], reason: str):
    config = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert wrong[0] in config
    (tmp_path / "pyproject.toml").write_text(config.replace(*wrong), encoding="utf-8")
    done = lint(tmp_path / "pyproject.toml")
    assert done.returncode == 1
    assert reason in done.stdout


def test_no_module_stands_beside_the_folders():
    modules = {name for name in FILES if name.count(".") == 1 and FILES[name].stem != "__init__"}
    assert {name for name in modules if name.startswith("coupling.")} == set()


def test_every_folder_of_modules_says_what_is_in_it_and_is_installed():
    folders = {file.parent for file in FILES.values()}
    for folder in folders:
        file = folder / "__init__.py"
        assert file.is_file(), folder
        assert ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))), folder
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = config["tool"]["setuptools"]["packages"]
    assert {".".join(folder.relative_to(ROOT).parts) for folder in folders} | {"foam_cases"} == set(
        listed
    )


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
    assert "coupling.scene.scene" in set(imported("coupling.motion.shaking"))
    assert "cloth.material" in set(imported("coupling.scene.diaphragm"))
    assert "coupling.simulation.driver" in set(imported("coupling.api.runs"))  # inside a function
    assert "coupling.simulation.driver" not in set(imported("coupling.api.runs", at_import=True))


def classes(tree: ast.AST) -> Iterator[ast.ClassDef]:
    return (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))


def on_self(node: ast.AST) -> set[str]:
    """Attributes of ``self`` that are assigned somewhere in ``node``."""
    return {
        found.attr
        for found in ast.walk(node)
        if isinstance(found, ast.Attribute)
        and isinstance(found.ctx, ast.Store)
        and isinstance(found.value, ast.Name)
        and found.value.id == "self"
    }


def declared(cls: ast.ClassDef) -> set[str]:
    """What a class has from its ``__init__``, and its own and its dataclass' fields."""
    names = set()
    for node in cls.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names.add(node.target.id)
        elif isinstance(node, ast.Assign):
            names |= {target.id for target in node.targets if isinstance(target, ast.Name)}
        elif isinstance(node, ast.FunctionDef) and node.name == "__init__":
            names |= on_self(node)
    return names


def born_late(trees: list[ast.AST]) -> list[str]:
    """Attributes that a method makes which neither the class nor those it is built on declare."""
    known = {cls.name: cls for tree in trees for cls in classes(tree)}

    def inherited(cls: ast.ClassDef) -> set[str]:
        bases = (known.get(base.id) for base in cls.bases if isinstance(base, ast.Name))
        return declared(cls).union(*(inherited(base) for base in bases if base is not None))

    return [
        f"{cls.name}.{name}"
        for tree in trees
        for cls in classes(tree)
        for name in sorted(on_self(cls) - inherited(cls))
    ]


def test_no_attribute_is_born_outside_init():
    trees: list[ast.AST] = [ast.parse(file.read_text(encoding="utf-8")) for file in FILES.values()]
    assert born_late(trees) == []


def test_an_attribute_that_is_born_late_is_seen():
    late = """
class Base:
    kept: int
    def __init__(self): self.own = 1
class Child(Base):
    def move(self):
        self.own, self.kept = 2, 3
        self.late = 4
        self.pair, other.late = 5, 6
"""
    assert born_late([ast.parse(late)]) == ["Child.late", "Child.pair"]


def test_only_one_module_compiles():
    """What is kept on the disk is checked when it is read: by that module alone."""
    for package in ("cloth", "coupling"):
        for path in (ROOT / package).rglob("*.py"):
            if path.parent.name != "cloth" or not path.name.startswith("compiled"):
                assert "numba.njit" not in path.read_text(encoding="utf-8"), path


def strings_of(tree: ast.Module) -> Iterator[ast.Constant]:
    """String constants that are no docstrings."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, documented)
        and node.body
        and isinstance(node.body[0], ast.Expr)
        and isinstance(node.body[0].value, ast.Constant)
    }
    for node in ast.walk(tree):
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str):
            continue
        if id(node) not in docstrings:
            yield node


# where a fluid model's name stands for something else, and why
OTHER_MEANINGS = {
    ("coupling.report.viewer", "hydrostatic"),  # a part of the pressure
    ("coupling.report.figures", "hydrostatic"),
    ("coupling.foam.installation", "openfoam"),  # the package of Debian
    ("coupling.scene.scene", "openfoam"),
}


def test_no_fluid_model_is_named_outside_of_the_fluids():
    """But for the verification cases, which are each of one model or another."""
    names, theirs = set(FLUIDS), ("coupling.fluids", "coupling.verify")
    found = {
        (name, node.value)
        for name, file in FILES.items()
        if name.startswith("coupling.") and not name.startswith(theirs)
        for node in strings_of(ast.parse(file.read_text(encoding="utf-8")))
        if node.value in names
    }
    assert found <= OTHER_MEANINGS, sorted(found - OTHER_MEANINGS)


CALLED_FROM_OUTSIDE = {
    "setup",  # by Dask, of a worker's plug-in
    "MechanicalModel",  # by the simulator that opens a Functional Mock-up Unit
    "do_step",
    "crossing_pairs",  # by whoever judges a sheet: whether parts of it are in each other
    "membrane_stiffness",  # exact answers are made of it
    "fill_fraction_of_level",  # the inverse that the level is held against
}


def test_every_public_function_is_used():
    """By the packages or the cases; a definition that only a test calls is of no use to a run.

    But for the plain references that compiled kernels are held against.
    """
    used: set[str] = set()
    defined: dict[str, str] = {}
    for file in (*FILES.values(), *(ROOT / "foam_cases").rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Name):
                used.add(node.id)
            elif isinstance(node, ast.Attribute):
                used.add(node.attr)
            elif isinstance(node, ast.ImportFrom):
                used |= {alias.name for alias in node.names}
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                used.add(node.value.rpartition(":")[2])  # an entry of a list
        if "reference" in file.stem:
            continue
        for owner in (tree, *(node for node in tree.body if isinstance(node, ast.ClassDef))):
            for node in owner.body:
                kinds = (ast.FunctionDef, ast.ClassDef)
                if isinstance(node, kinds) and not node.name.startswith("_"):
                    defined[node.name] = f"{file.relative_to(ROOT)}: {node.name}"
    unused = [place for name, place in defined.items() if name not in used | CALLED_FROM_OUTSIDE]
    assert not unused, "\n".join(unused)


def test_steps_are_not_asked_for_their_kind():
    steps = {"DryStep", "PotentialStep", "OpenFoamStep", "CoupledStep"}
    for name, file in FILES.items():
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
                asked = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
                assert not asked & steps, name
