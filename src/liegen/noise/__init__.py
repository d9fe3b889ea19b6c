"""Noise and robust losses: whitening a residual and its Jacobians, and weighing them by a loss.

Convention: the cost of a factor is 1/2 rho(s) with s = |S r|^2, r the residual and S = ``sqrt_info`` the
square root of the information matrix, S^T S = covariance^-1.
"""

from __future__ import annotations

from .extend import cost_graph as cost_graph
from .extend import weighted_graph as weighted_graph
from .losses import LOSSES as LOSSES
from .losses import Loss as Loss
from .models import NOISES as NOISES
from .models import Noise as Noise
from .weigh import MODES as MODES
from .weigh import Weight as Weight
from .weigh import Weighted as Weighted
from .weigh import Weighting as Weighting
from .weigh import weighting as weighting
