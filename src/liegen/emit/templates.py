"""Where the templates are, and how Jinja2 reads them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from liegen.text import c_comment, c_string, docstring, hash_comment

from .precision import in_single


def template_folder() -> Path:
    """``liegen/templates`` of an installed wheel, else ``templates/`` beside ``src/`` of a checkout."""
    package = Path(str(resources.files("liegen")))
    inside = package / "templates"
    return inside if inside.is_dir() else package.parents[1] / "templates"


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(template_folder(), encoding="utf-8"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        auto_reload=False,
    )
    filters: dict[str, Any] = {
        "c_comment": c_comment,
        "c_string": c_string,
        "docstring": docstring,
        "hash_comment": hash_comment,
        "in_single": in_single,
    }
    environment.filters.update(filters)
    return environment


def lay_out(template: str, names: Mapping[str, object]) -> str:
    """The text of a template."""
    return _environment().get_template(template).render(names)
