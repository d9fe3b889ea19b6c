"""Imports point one way, along the path of a factor."""

import ast
from pathlib import Path

import pytest

import liegen

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "liegen"
#: A part may import the parts before it in this order.
LAYERS = (
    "errors", "exits", "text", "advice", "names", "algebra", "coefficients", "manifolds", "charts", "layouts",
    "uncertainty", "trace", "differentiate", "noise", "program", "kernel", "choice", "derive", "gauss_newton",
    "arguments", "define", "decorate",
    "samples", "library", "modules", "undisturbed", "user_code", "sources", "emit",
    "temporary", "subprocesses", "native", "runtime", "verify", "accuracy", "foreign", "bench", "explain",
    "cli",
)  # fmt: skip
#: The lazy package root names everything.
ROOT_FILES = ("__init__", "__main__")


def part(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imports(path: Path):
    """liegen parts that a module imports, with the line."""
    package = ("liegen", *path.relative_to(SOURCE).parts[:-1])
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [a.name for a in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            names = (
                [".".join((*base, node.module))]
                if node.module
                else [".".join((*base, a.name)) for a in node.names]
            )
        else:
            continue
        for name in names:
            if name.startswith("liegen."):
                yield name.split(".")[1], node.lineno


MODULES = [p for p in sorted(SOURCE.rglob("*.py")) if part(p) not in ROOT_FILES]


def test_every_part_has_its_layer():
    assert {part(p) for p in MODULES} <= set(LAYERS)
    assert len(MODULES) > 40


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCE)))
def test_imports_point_one_way(path):
    for target, line in imports(path):
        if target in LAYERS:
            assert LAYERS.index(target) <= LAYERS.index(part(path)), (
                f"{path.name}:{line} imports liegen.{target}"
            )


def test_files_are_small():
    long = {p.name: n for p in SOURCE.rglob("*.py") if (n := len(p.read_text().splitlines())) > 350}
    templates = {
        p.name: n for p in (ROOT / "templates").rglob("*.j2") if (n := len(p.read_text().splitlines())) > 60
    }
    assert long == {}
    assert templates == {}


def test_no_module_shares_a_name_with_what_its_package_offers():
    for init in SOURCE.rglob("__init__.py"):
        folder = init.parent
        modules = {p.stem for p in folder.glob("*.py")}
        modules |= {p.parent.name for p in folder.glob("*/__init__.py")}
        statements = [n for n in ast.walk(ast.parse(init.read_text())) if isinstance(n, ast.ImportFrom)]
        offered = {a.asname or a.name for n in statements if n.module for a in n.names}
        assert modules & offered == set(), folder.name
    assert callable(liegen.factor)
    assert set(liegen._HOME) & {p.stem for p in SOURCE.glob("*.py")} == set()
