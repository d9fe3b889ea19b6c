"""What the user wrote where something went wrong: the expression in the source, and what its names mean."""

from __future__ import annotations

import ast
import linecache
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice
from types import CodeType, FrameType, TracebackType
from typing import Any

_LOOSE = (ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.Lambda, ast.Starred)
#: Methods whose result has the class of the value.
_SAME = ("inverse", "compose", "between", "retract")


@dataclass(frozen=True)
class Written:
    """The innermost expression that was being run, what is around it (innermost first), and the names."""

    node: ast.AST
    around: tuple[ast.AST, ...]
    names: Mapping[str, Any]


@dataclass(frozen=True)
class Text:
    """An expression in a message: ``{x}``, or ``{x:a}`` with parentheses where an operator may follow."""

    plain: str
    loose: bool = False

    def __format__(self, spec: str) -> str:
        return f"({self.plain})" if spec == "a" and self.loose else self.plain


def text_of(node: ast.AST) -> Text:
    """The expression as the user wrote it, but for spaces."""
    loose = isinstance(node, _LOOSE) or (isinstance(node, ast.Constant) and not _positive(node.value))
    return Text(ast.unparse(node), loose)


def _positive(value: object) -> bool:
    return not isinstance(value, int | float) or value >= 0


def written_in(frame: FrameType) -> Written | None:
    """The expression that a frame is running; None where there is no source."""
    return _written(frame.f_code, frame.f_lasti, frame)


def written_at(step: TracebackType) -> Written | None:
    """The expression at which an exception left a frame."""
    return _written(step.tb_frame.f_code, step.tb_lasti, step.tb_frame)


def _written(code: CodeType, instruction: int, frame: FrameType) -> Written | None:
    line, end, column, last = next(islice(code.co_positions(), instruction // 2, None), (None,) * 4)
    if line is None or end is None or column is None or last is None:
        return None
    try:
        tree = ast.parse("".join(linecache.getlines(code.co_filename, frame.f_globals)))
    except (SyntaxError, ValueError):
        return None
    path = _path(tree, (line, column), (end, last))
    names = {**frame.f_builtins, **frame.f_globals, **frame.f_locals}
    return Written(path[0], tuple(path[1:]), names) if path else None


def _path(tree: ast.AST, start: tuple[int, int], end: tuple[int, int]) -> list[ast.AST]:
    """The nodes around a piece of the source, innermost first."""
    found: list[ast.AST] = []
    for child in ast.iter_child_nodes(tree):
        if not hasattr(child, "lineno"):  # such as the arguments of a function, or a comprehension's for
            found = _path(child, start, end)
            if found:
                return [*found, child] if isinstance(child, ast.comprehension) else found
            continue
        piece: Any = child
        if (piece.lineno, piece.col_offset) <= start and end <= (piece.end_lineno, piece.end_col_offset):
            return [*_path(child, start, end), child]
    return found


def _type(value: Any) -> type:
    return value.__class__


def kind_of(node: ast.AST, names: Mapping[str, Any]) -> type | None:
    """The class of an expression's value where that is told without running it."""
    if isinstance(node, ast.Name):
        return _type(names[node.id]) if node.id in names else None
    if isinstance(node, ast.Constant):
        return type(node.value)
    if isinstance(node, ast.List | ast.Tuple):
        return list
    if isinstance(node, ast.UnaryOp):
        return kind_of(node.operand, names)
    if isinstance(node, ast.Attribute):
        return _part(kind_of(node.value, names), node.attr)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "matrix":
        return type("RotationMatrix", (), {})
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _SAME:
        return kind_of(node.func.value, names)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        made = names.get(node.func.id)
        return made if isinstance(made, type) else None
    return None


def _part(holder: type | None, name: str) -> type | None:
    """The class of a property of a value."""
    import liegen

    if holder is None or not hasattr(holder, "form"):
        return None
    parts: Mapping[str, type] = getattr(holder, "part_classes", {})
    found = {
        "rotation": getattr(holder, "rotation_class", liegen.SO3),
        "pose": liegen.SE3,
        "scale": liegen.R1,
    }
    vectors = ("translation", "position", "velocity", "vector")
    return parts.get(name) or (liegen.Vector if name in vectors else found.get(name))


def called_name(node: ast.AST) -> str:
    """``norm`` of ``np.linalg.norm(p)``; empty where the function has no name."""
    func = node.func if isinstance(node, ast.Call) else None
    if isinstance(func, ast.Attribute):
        return func.attr
    return func.id if isinstance(func, ast.Name) else ""


def language() -> tuple[str, ...]:
    """The functions that a formula may use."""
    import liegen

    other = ("factor", "function", "compile", "frames", "outputs", "require", "singular")
    return tuple(n for n in liegen.__all__ if n.islower() and n not in other and n[0] != "_")


def _of_liegen(found: object) -> bool:
    return str(getattr(found, "__module__", "")).startswith("liegen")


def with_imports(text: str, names: Mapping[str, Any]) -> str:
    """The code, with the functions named as the user's file can: ``liegen.sin(x)``, or what to import."""
    import liegen

    own = "|".join(n for n in liegen.__all__ if n != "__version__")
    own_names = [n for n in liegen.__all__ if n not in ("factor", "function") and _of_liegen(names.get(n))]
    modules = (n for n, v in names.items() if v is sys.modules["liegen"])
    module = "" if own_names else next(modules, "")
    missing: list[str] = []

    def named(match: re.Match[str]) -> str:
        name = match[0]
        if _of_liegen(names.get(name)) or name == "abs":
            return name
        if module:
            return f"{module}.{name}"
        missing.append(name)
        return name

    shown = re.sub(rf"(?<![\w.])(?:{own})(?=[(.])(?!\.\w+ import)", named, text)
    return f"{shown} (from liegen import {', '.join(dict.fromkeys(missing))})" if missing else shown
