"""From a Python function to a graph of typed operations."""

from __future__ import annotations

from .formulas import formula as formula
from .graph import Domain as Domain
from .graph import Graph as Graph
from .graph import Parameter as Parameter
from .graph import topological as topological
from .jacobian_text import jacobian_formulas as jacobian_formulas
from .latex_text import latex as latex
from .latex_text import latex_rows as latex_rows
from .tracer import Outputs as Outputs
from .tracer import Signature as Signature
from .tracer import outputs as outputs
from .tracer import require as require
from .tracer import signature as signature
from .tracer import site_of as site_of
from .tracer import trace as trace
from .tracer import unknown_annotation as unknown_annotation
