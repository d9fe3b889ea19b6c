"""Charts of groups: what the coordinates of ``retract``, ``local`` and of a Jacobian's columns mean."""

from __future__ import annotations

from .chart import Chart as Chart
from .chart import Preset as Preset
from .contract import FormChart as FormChart
from .forms import form_chart as form_chart
from .forms import has_charts as has_charts
from .presets import GTSAM as GTSAM
from .presets import PRESETS as PRESETS
from .presets import preset as preset
