"""From a Python function to a graph of typed operations."""

from __future__ import annotations

from .charting import ChartLike as ChartLike
from .charting import in_charts as in_charts
from .defaults import constant as constant
from .formulas import formula as formula
from .frame_check import check_frames as check_frames
from .frame_names import Frames as Frames
from .frame_names import frames as frames
from .frame_names import print_name as print_name
from .frame_names import read_name as read_name
from .frame_report import FrameReport as FrameReport
from .graph import Call as Call
from .graph import Domain as Domain
from .graph import Graph as Graph
from .graph import Parameter as Parameter
from .graph import Singular as Singular
from .graph import topological as topological
from .jacobian_text import jacobian_formulas as jacobian_formulas
from .latex_names import latex_name as latex_name
from .latex_text import aligned as aligned
from .latex_text import latex as latex
from .latex_text import latex_rows as latex_rows
from .storing import LayoutLike as LayoutLike
from .storing import in_layouts as in_layouts
from .tracer import Outputs as Outputs
from .tracer import Signature as Signature
from .tracer import inlined as inlined
from .tracer import outputs as outputs
from .tracer import require as require
from .tracer import signature as signature
from .tracer import singular as singular
from .tracer import site_of as site_of
from .tracer import trace as trace
from .tracer import unknown_annotation as unknown_annotation
