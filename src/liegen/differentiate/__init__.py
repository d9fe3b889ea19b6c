"""Jacobians at group level: local blocks, their product along the graph, and its order."""

from __future__ import annotations

from .eliminate import STRATEGIES as STRATEGIES
from .fuse import fused as fused
from .graph_jacobian import Expressions as Expressions
from .graph_jacobian import Linearised as Linearised
from .graph_jacobian import expressions as expressions
from .graph_jacobian import jacobians as jacobians
from .graph_jacobian import linearised as linearised
from .nest import nested as nested
from .normal import Ladder as Ladder
from .normal import Terms as Terms
from .normal import ladder as ladder
from .normal import normal_terms as normal_terms
