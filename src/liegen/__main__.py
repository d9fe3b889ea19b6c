"""``python -m liegen``."""

from __future__ import annotations

from liegen.cli import main

if __name__ == "__main__":
    main()
