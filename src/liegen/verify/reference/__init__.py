"""An independent reference: graphs evaluated on matrix groups in mpmath, with at least 45 correct digits.

Nothing here uses liegen's closed forms, coefficient functions, derivatives, lowering or emission. Elements
are matrices of mpmath numbers (SO2 2 x 2, SO3 3 x 3, SE2 3 x 3, SE3 4 x 4), tuples (vectors, S2 and
calibrations), or bools (conditions). The exponential is ``expm``, the logarithm a closed form of the matrix.
"""

from __future__ import annotations

from .differences import jacobians as jacobians
from .interpreter import DIGITS as DIGITS
from .interpreter import Evaluation as Evaluation
from .interpreter import Sample as Sample
from .interpreter import difference as difference
from .interpreter import evaluate as evaluate
from .interpreter import from_coords as from_coords
from .interpreter import holds as holds
from .interpreter import local as local
from .interpreter import outputs as outputs
from .interpreter import retract as retract
from .interpreter import to_coords as to_coords
