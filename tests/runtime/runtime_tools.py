"""What the tests of compiled factors share."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from runtime_factors import arguments, rotated

import liegen

SOURCES = Path(liegen.__file__).parents[1]
R, p = arguments(rotated, (4,))[0]


def results(value):
    return list(value) if isinstance(value, tuple | list) else [value]


def close(a, b):
    for u, v in zip(results(a), results(b), strict=True):
        assert u.shape == v.shape
        np.testing.assert_allclose(u, v, rtol=1e-11, atol=1e-12)


def script(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


def entries(folder):
    return sorted(p.name for p in folder.iterdir())


def works(k):
    """The compiled ``rotated`` after a call with the right result."""
    quaternion, point = R[0], p[0]
    u, w = quaternion[:3], quaternion[3]
    turned = point + 2 * np.cross(u, np.cross(u, point) + w * point)
    np.testing.assert_allclose(k(R, p)[0], turned, rtol=1e-12)
    return k


def child(code, *arguments, **environment):
    env = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(SOURCES), str(Path(__file__).parent)]),
        **environment,
    }
    return subprocess.Popen(
        [sys.executable, "-c", code, *arguments], env=env,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
