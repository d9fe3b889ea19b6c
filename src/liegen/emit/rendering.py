"""From kernels to text: a pure function from values to ``{path: text}``."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

from liegen.errors import OutputError
from liegen.kernel import Kernel
from liegen.program import Program
from liegen.program.kinds import kinds
from liegen.text import in_json

from .header import closing, content, package_header
from .names import check_names
from .precision import precisions
from .target import Options, Target
from .targets import TARGETS
from .templates import lay_out

LAYOUTS = ("row", "col")
SCALARS = ("double", "float")
#: Says what a manifest is; changes when a reader of an older one would misread it.
FORMAT = "liegen manifest 1"


def render(
    kernels: Sequence[Kernel],
    targets: Sequence[str],
    *,
    package: str,
    regenerate: str,
    layout: str = "row",
    scalar: str = "double",
) -> dict[str, str]:
    """All files of a package, by relative path; the manifest ``<package>.json`` comes last.

    ``targets`` are names of :data:`TARGETS`; ``regenerate`` is the command line that makes the same files.
    ``layout`` ``"col"`` adds C functions with column-major Jacobians, ``scalar`` ``"float"`` those in single
    precision. Nothing is written. Raises :class:`DefinitionError` for names that some language refuses,
    :class:`OutputError` for an unknown target, layout or scalar.
    """
    rows = {target.name: target for target in TARGETS}
    _known("target", targets, list(rows))
    _known("layout", [layout], list(LAYOUTS))
    _known("scalar", [scalar], list(SCALARS))
    check_names(kernels, package)
    options = Options(package, regenerate, layout, scalar)
    chosen = [target for target in TARGETS if target.name in targets]
    files: dict[str, str] = {}
    for target in chosen:
        files |= _render_target(target, kernels, options)
    return {**files, f"{package}.json": _manifest(kernels, [t.name for t in chosen], options, files)}


def _known(what: str, given: Sequence[str], known: Sequence[str]) -> None:
    for name in given:
        if name not in known:
            raise OutputError(f"unknown {what} {name!r}; choose from {', '.join(known)}")
    if not given:
        raise OutputError(f"no {what} was chosen; choose from {', '.join(known)}")


def _render_target(target: Target, kernels: Sequence[Kernel], options: Options) -> dict[str, str]:
    printed = [{**target.printer(kernel, options), "package": options.package} for kernel in kernels]
    files = {
        sheet.path.format(package=options.package, factor=kernel.name): lay_out(sheet.template, names)
        for kernel, names in zip(kernels, printed, strict=True)
        for sheet in target.factor_sheets
        if sheet.made(options)
    }
    shared = {
        "package": options.package,
        "header": package_header(kernels, options),
        "closing": list(closing(options)),
        "content": content(kernels).capitalize(),
        "guard_macro": f"{options.package}_H".upper(),
        "factors": printed,
        "precisions": precisions(options.scalar),
        **target.package_names,
    }
    for sheet in filter(lambda sheet: sheet.made(options), target.package_sheets):
        files[sheet.path.format(package=options.package)] = lay_out(sheet.template, shared)
    return files


def digest(text: str) -> str:
    """SHA-256 of a text as it is written."""
    return hashlib.sha256(text.encode()).hexdigest()


def _manifest(
    kernels: Sequence[Kernel], targets: Sequence[str], options: Options, files: Mapping[str, str]
) -> str:
    content = {
        "format": FORMAT,
        "package": options.package,
        "options": {"targets": list(targets), "layout": options.layout, "regenerate": options.regenerate},
        "factors": {kernel.name: _facts(kernel) for kernel in kernels},
        "files": {path: digest(text) for path, text in files.items()},
    }
    return in_json(json.dumps(content, indent=2, sort_keys=True, ensure_ascii=False)) + "\n"


def _facts(kernel: Kernel) -> dict[str, Any]:
    return {
        "value": _counts(kernel.value),
        **({"jacobians": _jacobian_counts(kernel)} if kernel.variables else {}),
        "requirements": [r.message for r in kernel.value.requirements],
    }


def _jacobian_counts(kernel: Kernel) -> dict[str, Any]:
    """With the operations that each Jacobian alone adds to those of the outputs."""
    program, outputs = kernel.jacobians, [o.name for o in kernel.outputs]
    alone = program.operations_of(outputs)
    added = {
        port.name: program.operations_of([*outputs, port.name]) - alone
        for port in program.outputs
        if port.name not in outputs
    }
    return {**_counts(program), "operations_added_by": added}


def _counts(program: Program) -> dict[str, Any]:
    return {
        "operations": program.operations,
        "operations_by_kind": program.op_counts(),
        "kinds": kinds(program),
        "program_sha256": program.digest(),
    }
