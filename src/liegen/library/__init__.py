"""The built-in factors: the six rows of GTSAM's table, in 2D and 3D.

Names say the type: ``between_se3``, ``range_se2_r2``, ``projection_cal3_s2``. The forms that GTSAM evaluates,
where they differ from the documents' formula, end in ``_gtsam``.
"""

from __future__ import annotations

from .bearing import bearing_se2 as bearing_se2
from .bearing import bearing_se2_r2 as bearing_se2_r2
from .bearing import bearing_se3 as bearing_se3
from .bearing import bearing_se3_gtsam as bearing_se3_gtsam
from .bearing import bearing_se3_r3 as bearing_se3_r3
from .bearing import bearing_se3_r3_gtsam as bearing_se3_r3_gtsam
from .between import between_r2 as between_r2
from .between import between_r3 as between_r3
from .between import between_se2 as between_se2
from .between import between_se3 as between_se3
from .between import between_so2 as between_so2
from .between import between_so3 as between_so3
from .camera import projection_cal3_bundler as projection_cal3_bundler
from .camera import projection_cal3_ds2 as projection_cal3_ds2
from .camera import projection_cal3_s2 as projection_cal3_s2
from .camera import sfm_cal3_bundler as sfm_cal3_bundler
from .camera import sfm_cal3_s2 as sfm_cal3_s2
from .prior import prior_r2 as prior_r2
from .prior import prior_r3 as prior_r3
from .prior import prior_s2 as prior_s2
from .prior import prior_s2_gtsam as prior_s2_gtsam
from .prior import prior_se2 as prior_se2
from .prior import prior_se3 as prior_se3
from .prior import prior_so2 as prior_so2
from .prior import prior_so3 as prior_so3
from .range import range_r2 as range_r2
from .range import range_r3 as range_r3
from .range import range_se2 as range_se2
from .range import range_se2_r2 as range_se2_r2
from .range import range_se3 as range_se3
from .range import range_se3_r3 as range_se3_r3
