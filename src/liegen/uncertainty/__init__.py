"""Covariances on Lie groups: transport, order, sampling, whitening, posteriors, dead reckoning.

An uncertain element is ``T Exp(n)`` with ``n ~ N(0, S)``: S belongs to the tangent space at T, in the body
frame of T and in the order of its tangent (SE3: rotation [rad], then translation [m]; SE2: translation,
then angle). Everything works for every group (SO2, SE2, SO3, SE3, R^n), and broadcasts: elements of shape
(...), covariances of shape (..., n, n). Transport is of first order in n; what it leaves out is of fourth
order in n (Barfoot & Furgale 2014).

Sources: Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics" (2018), "micro Lie";
Barfoot & Furgale, "Associating uncertainty with three-dimensional poses for use in estimation problems"
(T-RO 2014); Mangelson, Ghaffari, Vasudevan, Eustice, "Characterizing the uncertainty of jointly distributed
poses in the Lie algebra" (T-RO 2020). The last two perturb on the left: their Ad_T stands where Ad_{T^-1}
stands here.
"""

from __future__ import annotations

from .change import from_chart as from_chart
from .change import to_chart as to_chart
from .covariance import block_diagonal as block_diagonal
from .covariance import joint as joint
from .covariance import packed as packed
from .covariance import propagate as propagate
from .covariance import sqrt_info as sqrt_info
from .covariance import squared_error as squared_error
from .covariance import whiten as whiten
from .estimate import posterior as posterior
from .estimate import sample as sample
from .order import from_order as from_order
from .order import from_ros as from_ros
from .order import to_order as to_order
from .order import to_ros as to_ros
from .track import Track as Track
from .track import dead_reckoning as dead_reckoning
from .transport import body_to_world as body_to_world
from .transport import of_between as of_between
from .transport import of_compose as of_compose
from .transport import of_inverse as of_inverse
from .transport import world_to_body as world_to_body
