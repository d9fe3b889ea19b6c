"""Names that languages and liegen's own templates keep for themselves: one list for all.

Macros of headers are in ``taken.txt``, which ``collect.py`` makes.
"""

from __future__ import annotations

import keyword
from collections.abc import Mapping


def words(text: str) -> frozenset[str]:
    """A set of words."""
    return frozenset(text.split())


#: C: ISO/IEC 9899:1999, 6.4.1; those of C23 that C++ lacks; GNU C.
_C = """
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile
    while asm typeof typeof_unqual
"""
#: C++: ISO/IEC 14882:2023, 5.11 and 5.12, beyond C's; those of C11 and C23 are among them.
_CPP = """
    alignas alignof and and_eq bitand bitor bool catch char16_t char32_t char8_t class co_await co_return
    co_yield compl concept const_cast consteval constexpr constinit decltype delete dynamic_cast explicit
    export false friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected
    public reinterpret_cast requires static_assert static_cast template this thread_local throw true try
    typeid typename using virtual wchar_t xor xor_eq
"""
#: Rust: The Rust Reference, "Keywords": those that r# does not make a name. Of the others bindings do.
_RUST = "crate self super Self"
#: CUDA C++ Programming Guide, "Built-in Variables". CUDA's keywords begin with underscores.
_CUDA = "threadIdx blockIdx blockDim gridDim warpSize"
#: By the name of the language.
KEYWORDS: Mapping[str, frozenset[str]] = {
    "Python": frozenset(keyword.kwlist),
    "C": words(_C),
    "C++": words(_CPP),
    "Rust": words(_RUST),
    "CUDA": words(_CUDA),
}
#: What the C of a factor uses, beside names that begin with the prefix of batches and variables that are
#: named as nothing of the factor is.
OWN_C = words("""
    status NULL NAN INFINITY linux unix sincos sqrt sin cos tan asin acos atan exp log fabs atan2 sqrtf sinf
    cosf tanf asinf acosf atanf expf logf fabsf atan2f block_ahead block_value block_jacobians block_value_cm
    block_jacobians_cm ptrdiff_t size_t uint8_t int32_t uintptr_t lanes memcpy copysign
""")
#: Batches begin their names with it.
PREFIXES = ("lanes_", "LANES")
#: What the NumPy code of a factor uses.
OWN_NUMPY = words("""
    np npt NamedTuple Array annotations evaluate flat values shapes invalid self cls
""")
#: How the output of a factor, and the single output of a function, is called: reserved for just that.
UNNAMED = frozenset(("res", "out"))
#: A field of a named tuple must not hide one of its methods.
TUPLE_METHODS = frozenset(("count", "index"))
#: What the C of a package defines, behind its prefix, beside the functions of its factors.
PACKAGE_SYMBOLS = words("""
    in in_f32 out out_f32 load store ahead ahead_to sincos atan2 RESTRICT H BATCH_H LANES_H LANES_F32_H MATH_H
""")
