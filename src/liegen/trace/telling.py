"""The error of a user's function: its line, the factor, what was said, what to write instead."""

from __future__ import annotations

import re

from liegen.advice import for_exception
from liegen.errors import DefinitionError, LiegenError
from liegen.manifolds.node import raised_at, site_at, user_steps
from liegen.text import exception_text


def told(name: str, error: BaseException) -> LiegenError:
    """What the factor ``name`` raised, as an error of liegen whose message begins with the user's line."""
    if isinstance(error, LiegenError):
        text = str(error)
        stated = re.match(r"[^:]+:\d+: ", text)
        site = stated[0] if stated else f"{raised_at(error)}: "
        return type(error)(f"{site}{name}: {text.removeprefix(site)}{_called_from(error)}")
    return DefinitionError(f"{raised_at(error)}: {name}: {_explained(error)}{_called_from(error)}")


def _explained(error: BaseException) -> str:
    """What Python said, and what a residual may do instead."""
    if not isinstance(error, Exception):
        return f"{exception_text(error)}; a formula returns a value, it does not end the program"
    steps = user_steps(error)
    cure = for_exception(error, steps[-1] if steps else None)
    return f"{exception_text(error)}; write {cure}" if cure else exception_text(error)


def _called_from(error: BaseException) -> str:
    """The factor's own line where a helper raised."""
    sites = list(dict.fromkeys(map(site_at, user_steps(error))))
    return f" (called at {sites[0]})" if len(sites) > 1 else ""
