"""What to write for a function or an attribute that is another library's, or misspelt."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Mapping, Sequence
from functools import cache
from inspect import getattr_static
from typing import Any

from .words import ATTRIBUTES, CLASSES, FUNCTIONS, OF_CLASSES, Words
from .written import Text, kind_of, language, text_of

#: What stands for arguments that the user did not write.
_STAND_INS = ("y", "z", "w")
#: Names of a class that are listed where no name is near.
_LISTED = 14


def folded(name: str) -> str:
    """Without case and underscores: ``squaredNorm`` and ``squared_norm`` are one name."""
    return name.replace("_", "").lower()


@cache
def _entries(table: tuple[tuple[str, str], ...]) -> dict[str, str]:
    return {word: written for words, written in table for word in words.split()}


def _looked_up(name: str, words: Words) -> str:
    """The row of a name; one that holds a capital counts as it is written, others without case."""
    entries = _entries(tuple(words.items()))
    return entries.get(name) or ("" if len(name) == 1 and name.isupper() else entries.get(folded(name), ""))


def families(kind: type) -> list[str]:
    """The classes that tables speak of, the nearest first."""
    return [cls.__name__ for cls in kind.__mro__]


def for_attribute(
    kind: type, name: str, x: Text, arguments: Sequence[ast.expr], names: Mapping[str, Any], *, of_class: bool
) -> str:
    """What to write for ``x.name(arguments)``; empty where nothing is near."""
    for family in families(kind):
        tables = ((OF_CLASSES if of_class else ATTRIBUTES).get(family, {}),)
        row = next((r for r in (_looked_up(name, t) for t in tables) if r), "")
        if not row and family == "Calibration" and name in kind.form.storage:  # type: ignore[attr-defined]
            row = ATTRIBUTES[family]["K fx fy f cx cy px py skew focal focallength principalpoint matrix"]
        if not row and family == "Product":
            row = _of_part(kind, name)
        if row:
            rotation = getattr(kind, "rotation_class", kind)
            return filled(
                row, arguments, names, x=x, cls=Text(kind.__name__), rotation=Text(rotation.__name__)
            )
        if family == "Vector" and not of_class and (near := _function_row(name)):
            whole = "{x}, {args}" if arguments else "{x}"
            moved = near.replace("{args}", whole).replace("{0", "{x").replace("{1", "{0").replace("{2", "{1")
            return filled(moved, arguments, names, x=x)
    near = _near(name, class_methods(kind) if of_class else public(kind))
    if near:
        given = ", ".join(map(ast.unparse, arguments))
        is_property = isinstance(getattr_static(kind, near), property)
        return f"{x:a}.{near}" + ("" if is_property else f"({given})")
    mean = "" if of_class else _near(name, language())
    return filled(f"{mean}({{x}})", arguments, names, x=x) if mean else ""


def _of_part(kind: type, name: str) -> str:
    """``{x:a}.pose.translation`` where a part has what is asked of the product."""
    declared: Any = kind
    parts: dict[str, type] = dict(declared.part_classes)
    near = _near(name, parts)
    if near:
        return f"{{x:a}}.{near}"
    if any(_looked_up(name, ATTRIBUTES[family]) for family in ("Group", "Manifold", "Value")):
        return ""
    for part, of in parts.items():
        if name in public(of) and name not in public(kind.__mro__[-2]):
            return f"{{x:a}}.{part}.{name}"
    for part, of in parts.items():
        for family in families(of)[:4]:
            row = _looked_up(name, ATTRIBUTES.get(family, {}))
            if row:
                return row.replace("{x:a}", f"{{x:a}}.{part}").replace("{x}", f"{{x:a}}.{part}")
    return ""


def public(kind: type) -> list[str]:
    """The attributes of a class that are meant for formulas."""
    return [
        n for n in dir(kind) if not n.startswith("_") and n not in ("form", "coords", "holding", "traced")
    ]


def class_methods(kind: type) -> list[str]:
    """What of it is called on the class: ``exp``, ``identity``, ..."""
    return [n for n in public(kind) if isinstance(getattr_static(kind, n), classmethod)]


def listed(kind: type) -> str:
    """``SE3 has adjoint, between, ...``, for a name that nothing is near to."""
    if "Vector" in families(kind):
        return f"it has entries [k], and the functions {', '.join(language())}"
    skipped = ("part_classes", "part_notes", "rotation_class", "bearing_class", "steps", "from_storage")
    shown = [n for n in public(kind) if n not in skipped]
    return f"it has {', '.join(shown[:_LISTED])}" + (", ..." if len(shown) > _LISTED else "")


def _near(name: str, among: Any) -> str:
    plain = {folded(n): n for n in among}
    found = difflib.get_close_matches(folded(name), plain, 1, 0.75)
    return plain[found[0]] if found else ""


def _function_row(name: str) -> str:
    """The row of a function: of the table, or of the language under the same name."""
    own = name.lower()
    if own in language():
        return f"{own}({{args}})"
    return _looked_up(name, FUNCTIONS)


def for_function(name: str, arguments: Sequence[ast.expr], names: Mapping[str, Any]) -> str:
    """What to write for ``name(arguments)``; empty where nothing is near."""
    row = _function_row(name)
    rows = arguments[0].elts if arguments and isinstance(arguments[0], ast.List | ast.Tuple) else []
    if rows and "stack(" in row and all(isinstance(r, ast.List | ast.Tuple) for r in rows):
        return f"stack({', '.join(f'dot({ast.unparse(r)}, v)' for r in rows)}) for this matrix @ v"
    if not row:
        near = _near(name, language())
        row = f"{near}({{args}})" if near else ""
    if name in ("dot", "matmul", "inner", "vdot") and _no_vector(arguments, names):
        row = "{0:a} @ {1:a}"
    if name in ("power", "pow", "float_power"):
        whole = (
            len(arguments) > 1 and isinstance(arguments[1], ast.Constant) and type(arguments[1].value) is int
        )
        row = "{0:a} ** {1:a}" if whole else "exp({1:a} * log({0}))"
    if name in ("any", "all"):
        return _joined("|" if name == "any" else "&", arguments)
    if name in ("max", "min", "maximum", "minimum", "fmax", "fmin"):
        return _extreme("maximum" if "max" in name else "minimum", arguments)
    return filled(row, arguments, names) if row else ""


def _no_vector(arguments: Sequence[ast.expr], names: Mapping[str, Any]) -> bool:
    """Whether the first factor is known to be a matrix, a rotation or the like."""
    kind = kind_of(arguments[0], names) if arguments else None
    return kind is not None and not {"Vector", "list", "float", "int"} & set(families(kind))


def _joined(sign: str, arguments: Sequence[ast.expr]) -> str:
    """``(x > 0) | (y > 0)`` for ``any([x > 0, y > 0])``."""
    parts = _spread(arguments)
    if len(parts) < 2:
        return f"(p[0] > 0) {sign} (p[1] > 0), each condition joined with {sign}"
    return f" {sign} ".join(f"{text_of(p):a}" for p in parts)


def _extreme(name: str, arguments: Sequence[ast.expr]) -> str:
    """``maximum(maximum(a, b), c)``."""
    parts = list(arguments)
    if len(parts) == 1 and isinstance(parts[0], ast.List | ast.Tuple):
        parts = parts[0].elts
    if len(parts) == 1 and isinstance(parts[0], ast.GeneratorExp | ast.ListComp):
        return f"{name}(a, b) of the entries, one after the other"
    if len(parts) == 1:
        x = text_of(parts[0])
        return f"{name}({x:a}[0], {x:a}[1])"
    shown = ast.unparse(parts[0]) if parts else "x"
    for part in parts[1:]:
        shown = f"{name}({shown}, {ast.unparse(part)})"
    return shown if len(parts) > 1 else f"{name}(x, y)"


def for_class(name: str) -> str:
    """The class of the language that another library calls ``name``."""
    import liegen

    own = [n for n in liegen.__all__ if n[0].isupper() and n not in ("Compiled", "Condition")]
    found = CLASSES.get(name) or next((n for n in own if folded(n) == folded(name)), "")
    return found or next(iter(difflib.get_close_matches(name, own, 1, 0.75)), "")


def filled(row: str, arguments: Sequence[ast.expr], names: Mapping[str, Any], **known: Text) -> str:
    """A row of the table with what the user wrote."""
    given = _spread(arguments)
    if ".between({0})" in row and len(given) > 1 and _is_number(given[0], names):
        given = [given[1], given[0]]
    texts = [_vector_of(a, names, row) for a in given]
    values = dict(known)
    values["v"] = texts[0] if texts else Text("v")
    values["args"] = Text(", ".join(t.plain for t in texts) or "x")
    padded = [*texts, *(Text(s) for s in _STAND_INS[len(texts) :])]
    if not texts and "x" not in known:
        padded[0] = Text("x")
    numbered = {str(k): t for k, t in enumerate(padded)}
    return row.format(*(numbered[str(k)] for k in range(len(padded))), **values)


def _spread(arguments: Sequence[ast.expr]) -> list[ast.expr]:
    """The entries of a list that is the only argument, else the arguments."""
    plain = [a for a in arguments if not isinstance(a, ast.Starred)]
    if len(plain) == 1 and isinstance(plain[0], ast.List | ast.Tuple) and plain[0].elts:
        return plain[0].elts
    return plain


def _is_number(argument: ast.expr, names: Mapping[str, Any]) -> bool:
    kind = kind_of(argument, names)
    return kind is not None and bool({"int", "float", "R1"} & set(families(kind)))


def _vector_of(argument: ast.expr, names: Mapping[str, Any], row: str) -> Text:
    """A direction inside ``dot`` and ``cross`` is its vector."""
    kind = kind_of(argument, names)
    text = text_of(argument)
    if kind is not None and "S2" in families(kind) and row.startswith(("dot(", "cross(", "norm(")):
        return Text(f"{text:a}.vector")
    return text


def arguments_of(node: ast.AST | None) -> list[ast.expr]:
    """The positional arguments of a call."""
    return node.args if isinstance(node, ast.Call) else []
