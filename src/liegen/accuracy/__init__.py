"""Errors of emitted code by rotation angle, in every chart, against the reference; the same of peers."""

from __future__ import annotations

from .figures import BOUND as BOUND
from .figures import Figure as Figure
from .points import COLUMNS as COLUMNS
from .points import NO_ANGLE as NO_ANGLE
from .report import AccuracyReport as AccuracyReport
from .report import largest as largest
from .run import SAMPLES as SAMPLES
from .run import accuracy as accuracy
from .undefined import Undefined as Undefined
