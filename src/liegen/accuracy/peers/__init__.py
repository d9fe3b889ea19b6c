"""The same figures of other libraries, where they are installed."""

from __future__ import annotations

from .measured import PeerReport as PeerReport
from .measured import measure_peers as measure_peers
