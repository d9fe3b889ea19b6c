"""From kernels to NumPy and C text, and from text to a tree on disk."""

from __future__ import annotations

from .manifest import Manifest as Manifest
from .manifest import manifests as manifests
from .names import check_names as check_names
from .rendering import LAYOUTS as LAYOUTS
from .rendering import render as render
from .target import Options as Options
from .target import Sheet as Sheet
from .target import Target as Target
from .targets import TARGETS as TARGETS
from .tree import Change as Change
from .tree import TreeReport as TreeReport
from .tree import check_tree as check_tree
from .write import Written as Written
from .write import put_back as put_back
from .write import write_tree as write_tree
