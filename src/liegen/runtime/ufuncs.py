"""gufuncs from a plain shared object: NumPy's own C function, found in its table, called through ctypes."""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

#: PyUFunc_FromFuncAndDataAndSignature in the table of NumPy's ufunc API, the same in 1.x and 2.x.
_FROM_SIGNATURE = 31
#: PyUFunc_None: a reduction would have no identity.
_NO_IDENTITY = -1


class _Description(ctypes.Structure):
    """The structure ``gufunc`` of ``templates/runtime/strided.c.j2``."""

    _fields_ = (
        ("loops", ctypes.c_void_p),
        ("data", ctypes.c_void_p),
        ("types", ctypes.c_void_p),
        ("ntypes", ctypes.c_int),
        ("nin", ctypes.c_int),
        ("nout", ctypes.c_int),
        ("name", ctypes.c_void_p),
        ("doc", ctypes.c_void_p),
        ("signature", ctypes.c_void_p),
    )


@cache
def _constructor() -> Any:
    """``PyUFunc_FromFuncAndDataAndSignature`` as a function of ctypes that holds the interpreter's lock."""
    module: Any = importlib.import_module("numpy._core._multiarray_umath")
    address_of = ctypes.pythonapi.PyCapsule_GetPointer
    address_of.restype, address_of.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    table = ctypes.cast(address_of(module._UFUNC_API, None), ctypes.POINTER(ctypes.c_void_p))
    pointer, number = ctypes.c_void_p, ctypes.c_int
    arguments = [pointer] * 3 + [number] * 4 + [pointer] * 2 + [number, pointer]
    return ctypes.PYFUNCTYPE(ctypes.py_object, *arguments)(table[_FROM_SIGNATURE])


@dataclass(frozen=True, eq=False)
class Made:
    """A gufunc, and what must live as long as it: NumPy keeps pointers."""

    call: np.ufunc
    kept: tuple[Any, ...]


def made_gufunc(loop: Any, told: Any, types: Sequence[int], name: str, inputs: int, signature: str) -> Made:
    """A gufunc of one loop.

    ``loop`` is a function of ctypes, which gets the address of ``told``; ``types`` are NumPy's numbers of the
    operands' types, ``inputs`` of which are read.
    """
    loops, data = (ctypes.c_void_p * 1)(), (ctypes.c_void_p * 1)()
    loops[0], data[0] = ctypes.cast(loop, ctypes.c_void_p), ctypes.addressof(told)
    codes = (ctypes.c_char * len(types))(*types)
    texts = [ctypes.create_string_buffer(text.encode()) for text in (name, signature)]
    title, shapes = map(ctypes.addressof, texts)
    pointers = [ctypes.addressof(part) for part in (loops, data, codes)]
    made = _constructor()(*pointers, 1, inputs, len(types) - inputs, _NO_IDENTITY, title, None, 0, shapes)
    return Made(made, (loop, told, loops, data, codes, texts))


@cache
def joined_gufunc(libraries: tuple[ctypes.CDLL, ...], symbol: str) -> Made:
    """One gufunc with the loops of several shared objects, in the order in which NumPy tries their types.

    It is kept for the life of the process, as the libraries are.
    """
    parts = [_Description.in_dll(library, symbol) for library in libraries]
    d, operands = parts[0], parts[0].nin + parts[0].nout
    loops, data = ((ctypes.c_void_p * len(parts))() for _ in range(2))
    for k, part in enumerate(parts):
        loops[k] = ctypes.cast(part.loops, ctypes.POINTER(ctypes.c_void_p))[0]
    codes = b"".join(ctypes.string_at(part.types, operands) for part in parts)
    types = (ctypes.c_char * len(codes))(*codes)
    pointers = [ctypes.addressof(part) for part in (loops, data, types)]
    made = _constructor()(*pointers, len(parts), d.nin, d.nout, _NO_IDENTITY, d.name, d.doc, 0, d.signature)
    return Made(made, (libraries, loops, data, types))


def gufunc(library: ctypes.CDLL, symbol: str) -> np.ufunc:
    """The gufunc that the shared object describes under ``symbol``.

    NumPy keeps pointers to loops, types and texts: they are static data of the library, which is never
    unloaded.
    """
    d = _Description.in_dll(library, symbol)
    return _constructor()(
        d.loops, d.data, d.types, d.ntypes, d.nin, d.nout, _NO_IDENTITY, d.name, d.doc, 0, d.signature
    )
