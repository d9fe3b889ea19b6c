"""Which names a factor, its arguments and its outputs may have, so that every language can spell them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence

from liegen.errors import DefinitionError

from .derived import SQRT_INFO, derived_names, jacobian_name
from .headers import taken
from .keywords import KEYWORDS, OWN_C, OWN_NUMPY, PREFIXES, TUPLE_METHODS, UNNAMED

#: Longest name: files are called by the name of a factor, and more.
LONGEST = 100
_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TEMPORARY = re.compile(r"t[0-9]+")
_MACROS = ("macros of C", "macros of C++")


def complaint(name: str) -> str:
    """Why a name cannot be used anywhere, or nothing."""
    if not _IDENTIFIER.fullmatch(name):
        return "is no C identifier (letters, digits and underscores, a letter first)"
    if len(name) > LONGEST:
        return f"is longer than {LONGEST} characters"
    if "__" in name:
        return "holds a double underscore, which C++ keeps for itself"
    languages = [language for language, known in KEYWORDS.items() if name in known]
    return f"is a {languages[0]} keyword" if languages else ""


def own(name: str) -> str:
    """Why liegen's templates keep a name for themselves, or nothing."""
    if name in OWN_C or name in OWN_NUMPY or name in UNNAMED or name.startswith(PREFIXES):
        return "is reserved for the generated code"
    return "is the name of a temporary in the generated code" if _TEMPORARY.fullmatch(name) else ""


def reserved(name: str) -> str:
    """Why a name cannot be that of an argument or output, or nothing."""
    macro = next((title for title in _MACROS if name in taken()[title]), "")
    return own(name) or (f"is one of the {macro}'s headers, so it is reserved" if macro else "")


def macro(name: str) -> bool:
    """Whether a header of C or C++ may define the name."""
    return any(name in taken()[title] for title in _MACROS)


def proposal(name: str) -> str:
    """A name that may be used instead."""
    stem = re.sub(r"_D_|[^A-Za-z0-9]+", "_", name).strip("_")[: LONGEST // 2]
    stem = stem if stem[:1].isalpha() else f"v_{stem}".rstrip("_")
    return f"{stem}_1" if stem == name or complaint(stem) or reserved(stem) else stem


def refuse(subject: str, name: str, why: str) -> None:
    """Raise DefinitionError where there is a complaint."""
    if why:
        raise DefinitionError(f"{subject} {why}; rename it, for example to {proposal(name)!r}")


def check_factor_name(name: str, site: str) -> None:
    """Raise DefinitionError for a factor that no language could call so."""
    refuse(f"factor {shown(name)} ({site}): its name", name, complaint(name) or own(name))


def shown(name: str) -> str:
    """A name in quotes, shortened."""
    return repr(name if len(name) <= LONGEST else f"{name[:20]}...")


def check_arguments(where: str, names: Sequence[str], outputs: Collection[str]) -> None:
    """Raise DefinitionError for a name that some language refuses, occurs twice, or is that of an output."""
    seen: set[str] = set()
    for name in names:
        why = complaint(name) or reserved(name) or _clash(name, seen, outputs)
        refuse(f"{where}: argument {shown(name)}", name, why)
        seen.add(name)


def check_outputs(where: str, names: Sequence[str]) -> None:
    """The same of outputs."""
    seen: set[str] = set()
    for name in names:
        why = complaint(name) or ("" if name in UNNAMED else reserved(name)) or _clash(name, seen, ())
        why = why or ("is a method of every named tuple" if name in TUPLE_METHODS else "")
        refuse(f"{where}: output {shown(name)}", name, why)
        seen.add(name)


def _clash(name: str, seen: Iterable[str], outputs: Iterable[str]) -> str:
    if name in seen:
        return "occurs twice"
    if name in outputs:
        return "is also the name of an output"
    if "_D_" in name:
        return "looks like the name of a Jacobian ('_D_' stands between an output and a variable)"
    return ""


def check_definition(
    name: str, site: str, arguments: Sequence[str], variables: Sequence[str], outputs: Sequence[str],
    *, factor: bool,
) -> None:  # fmt: skip
    """Raise DefinitionError for names that clash in any use of a factor: code, Gauss-Newton terms, noise.

    ``site`` is its line. The message names factor, argument and cure. The name of the factor itself, which
    may change, the outputs of a ``@function``, which may only be called from Python, and what depends on the
    package are checked where code is made.
    """
    where = f"{name} ({site})"
    check_arguments(where, arguments, ())
    if factor and SQRT_INFO in arguments:
        raise DefinitionError(
            f"{where}: argument {SQRT_INFO!r} is also what noise or loss adds (the square root of the "
            "information); rename the argument, for example to 'root_info'"
        )
    counted = Counter(derived_names(outputs, variables, factor=factor))
    for made, times in counted.items():
        if made in arguments or made in outputs or times > 1:
            raise DefinitionError(f"{where}: {_doubled(made, arguments, variables, outputs)}")


def _doubled(made: str, arguments: Collection[str], variables: Sequence[str], outputs: Sequence[str]) -> str:
    jacobians = {jacobian_name(o, v) for o in outputs for v in variables}
    what = (
        "a Jacobian" if made in jacobians
        else "the cost of Gauss-Newton terms" if made == "cost"
        else "a block of Gauss-Newton terms"
    )  # fmt: skip
    if made in arguments:
        return f"argument {made!r} is also the name of {what}; rename it, for example to {proposal(made)!r}"
    if made in outputs:
        return f"output {made!r} is also the name of {what}; rename it, for example to {proposal(made)!r}"
    return f"two blocks of Gauss-Newton terms would be called {made!r}; rename one of the variables"
