r"""Text that others wrote, made safe for where it is shown: a function per language, one for terminals.

Docstrings, messages and file names may hold anything. What cannot be seen (control characters, marks that
turn the direction of writing, halves of surrogate pairs) is shown by its escape, such as ``\x1b``; what would
end a comment or a literal is escaped or parted. Everything else stays as it is.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence

from liegen.exits import no_exit

#: Categories of Unicode that nobody sees: control, format, surrogate, private use, separators of lines.
_UNSEEN = frozenset(("Cc", "Cf", "Cs", "Co", "Zl", "Zp"))
#: What the C preprocessor may read as one character, such as ??/ for a backslash.
_TRIGRAPH = re.compile(r"\?\?(?=[=/'()!<>-])")
#: In the first two lines of a Python file a comment such as "coding: name" chooses the encoding.
_CODING = re.compile(r"coding(?=[:=])")
_LATEX = {
    **{c: f"\\{c}" for c in "_$&#%{}"},
    "\\": r"\backslash{}", "^": r"\hat{}", "~": r"\sim{}",
}  # fmt: skip

#: Characters of an error's text that are shown.
LONGEST = 500


def _seen(char: str) -> str:
    if " " <= char <= "~":
        return char
    category = unicodedata.category(char)
    if category == "Zs" or char == "\t":
        return " "
    return ascii(char)[1:-1] if category in _UNSEEN else char


def one_line(text: str) -> str:
    r"""The text in one line that can be seen: ``\n`` for a line break, ``\x1b`` for an escape character."""
    return text if text.isascii() and text.isprintable() else "".join(map(_seen, text))


def printable(text: object, limit: int | None = None) -> str:
    """What a terminal may show of any text: its lines, each by :func:`one_line`.

    With a ``limit`` at most so many characters, then how many are left out. An object is shown as ``str``
    says; where that fails, by its type.
    """
    try:
        whole = str(text)
    except Exception:
        whole = f"<{type(text).__name__} that cannot be shown>"
    left_out = len(whole) - limit if limit is not None else 0
    shown = "\n".join(one_line(line) for line in whole[:limit].split("\n"))
    return f"{shown} ... ({left_out} more characters)" if left_out > 0 else shown


def exception_text(error: BaseException) -> str:
    """``ValueError: why`` in one line; the type alone where there is no text.

    With what it was raised from, if any: ``ValueError: why (caused by KeyError: 'a')``.
    """
    cause = error.__cause__
    return _said(error) if cause is None else f"{_said(error)} (caused by {_said(cause)})"


def _said(error: BaseException) -> str:
    try:
        with no_exit():
            whole = str(error)
    except BaseException:  # __str__ is the user's code too
        whole = "(its text cannot be shown: str() of it fails)"
    text = printable(" ".join(whole.split()), LONGEST)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def hash_comment(lines: Sequence[str]) -> str:
    """A block of ``#`` comments, which may open a Python file."""
    shown = [f"# {one_line(line)}".rstrip() for line in lines]
    return "\n".join([*(_CODING.sub("coding ", line) for line in shown[:2]), *shown[2:]])


def c_comment(lines: Sequence[str]) -> str:
    """A C comment; whatever the text holds, it neither ends the comment nor opens one within."""
    return "/*\n" + "\n".join(f" * {_in_c_comment(line)}".rstrip() for line in lines) + "\n */"


def _in_c_comment(line: str) -> str:
    return _TRIGRAPH.sub("? ?", one_line(line).replace("*/", "* /").replace("/*", "/ *"))


def docstring(lines: Sequence[str], indent: int) -> str:
    """A Python docstring; whatever the text holds, it does not end the literal."""
    safe = [one_line(line).rstrip().replace("\\", "\\\\").replace('"""', '\\"\\"\\"') for line in lines]
    pad = " " * indent
    body = "\n".join(f"{pad}{line}".rstrip() for line in safe).lstrip()
    end = f"\n{pad}" if len(safe) > 1 else " " if body.endswith('"') else ""
    return f'"""{body}{end}"""'


def c_string(text: str) -> str:
    """A C string literal, one line of text a line."""
    lines = [_in_c_string(line) for line in text.split("\n")]
    return "\n    ".join(f'"{line}"' for line in [*(f"{line}\\n" for line in lines[:-1]), lines[-1]])


def _in_c_string(line: str) -> str:
    plain = {ord(c): f"\\{c}" for c in '"\\?'}  # ?: no trigraphs
    escaped = one_line(line).translate(plain)
    return "".join(c if " " <= c <= "~" else "".join(f"\\{b:03o}" for b in c.encode()) for c in escaped)


def in_json(text: str) -> str:
    """JSON whose strings hold no character that cannot be seen, nor one that UTF-8 cannot hold."""
    return "".join(c if c == "\n" or _seen(c) in (c, " ") else _json_escape(c) for c in text)


def _json_escape(char: str) -> str:
    units = char.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[k]:02x}{units[k + 1]:02x}" for k in range(0, len(units), 2))


def in_latex(text: str) -> str:
    r"""``rear\_left`` of ``rear_left``: each special character of LaTeX as itself, in mathematics too."""
    return "".join(_LATEX.get(c, c) for c in one_line(text))


def latex_comment(lines: Iterable[str]) -> str:
    """Lines that begin with ``%``, each ended."""
    return "".join(f"% {one_line(line)}\n" for line in lines)
