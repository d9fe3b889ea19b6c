"""The process that a foreign function runs in.

Requests come from standard input and answers go to standard output, one pickle each. What the function
prints goes to standard error. A request is a Request or the list of stored arguments of one call; an answer
is a pair: what it is, and that.
"""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import BinaryIO

from liegen.errors import LiegenError, ToolError

from .calls import Array, Loaded, loaded
from .returned import RaisedError
from .signature import Signature

#: What an answer may be.
LOADED, RESULTS, RAISED, FAILED = "loaded", "results", "raised", "failed"


@dataclass(frozen=True)
class Request:
    """What to load, first of all."""

    place: str
    expected: Signature
    given: Mapping[str, str]


def main() -> None:
    """Serve until standard input ends."""
    requests = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # prints of the function, of C code too
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    sys.stdout = sys.stderr
    found: Loaded | None = None
    while True:
        try:
            request = pickle.load(requests)
        except EOFError:
            return
        if isinstance(request, Request):
            found = _load(request, answers)
        else:
            _call(found, request, answers)


def _load(request: Request, answers: BinaryIO) -> Loaded | None:
    try:
        found = loaded(request.place, request.expected, request.given)
    except LiegenError as error:
        _answer(answers, FAILED, (type(error).__name__, str(error)))
        return None
    _answer(answers, LOADED, (dict(found.given), found.own))
    return found


def _call(found: Loaded | None, arguments: Sequence[Array], answers: BinaryIO) -> None:
    try:
        if found is None:
            raise ToolError("nothing is loaded")
        results = found.call(arguments)
    except RaisedError as error:
        _answer(answers, RAISED, str(error))
    except LiegenError as error:
        _answer(answers, FAILED, (type(error).__name__, str(error)))
    else:
        _answer(answers, RESULTS, results)


def _answer(answers: BinaryIO, kind: str, content: object) -> None:
    pickle.dump((kind, content), answers)
    answers.flush()
