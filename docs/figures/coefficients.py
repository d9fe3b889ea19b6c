"""Draws docs/figures/coefficients.svg: error of each coefficient function against the angle.

``python docs/figures/coefficients.py [FILE]``; needs matplotlib (``pip install 'liegen[examples]'``).
The same bytes in every run with the same versions of matplotlib and NumPy.
"""

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from liegen.coefficients import measurement, tables

BINS, PER_BIN = 120, 12
FLOOR, CEILING = 0.2, 1e18  # ulp; a larger error is drawn at the top
SMALLEST = 1e-9  # rad
LIBRARY, TEXTBOOK, LINE = "#1f5fa8", "#d1721b", "#888888"
TITLES = {
    "c0": r"$c_0 = \cos\theta$",
    "c1": r"$c_1 = \sin\theta\,/\,\theta$",
    "c2": r"$c_2 = (1 - \cos\theta)\,/\,\theta^2$",
    "c3": r"$c_3 = (\theta - \sin\theta)\,/\,\theta^3$",
    "c4": r"$c_4 = (\theta^2/2 - 1 + \cos\theta)\,/\,\theta^4$",
    "c5": r"$c_5 = (\theta^3/6 - \theta + \sin\theta)\,/\,\theta^5$",
    "D": r"$D = 1/\theta^2 - (1 + \cos\theta)\,/\,(2\theta\sin\theta)$",
    "E": r"$E = (dD/d\theta)\,/\,\theta$",
    "log factor": r"$2\,\mathrm{acos}(w)\,/\,\sqrt{1 - w^2}$,  $w = \cos(\theta/2)$",
}
BOUNDS = {"E": 8.0}
SWITCHES = {"c3": tables.STUMPFF3_END, "c4": tables.STUMPFF5_END, "c5": tables.STUMPFF5_END}
STYLE = {
    "svg.hashsalt": "liegen",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "path.simplify": False,
}


def angles(high):
    """(BINS, PER_BIN) angles, each bin a step of the logarithm up to ``high``."""
    steps = np.arange(BINS)[:, None] + measurement.spread(0.0, 1.0, BINS * PER_BIN).reshape(BINS, PER_BIN)
    return SMALLEST * (high / SMALLEST) ** (steps / BINS)


def worst(error, unit):
    """The largest error of each bin in ulp, NaN where the formula gives NaN somewhere in the bin."""
    return np.clip((error / unit).reshape(BINS, PER_BIN).max(axis=1), FLOOR, CEILING)


def panel(axes, errors):
    theta = np.exp(np.log(errors.theta).reshape(BINS, PER_BIN).mean(axis=1))
    textbook = worst(errors.textbook, errors.unit)
    axes.loglog(theta, textbook, color=TEXTBOOK, lw=2.0, label="textbook formula")
    undefined = np.isnan(textbook)
    if undefined.any():
        last = theta[undefined].max()
        axes.axvspan(SMALLEST, last, color=TEXTBOOK, alpha=0.15, lw=0)
        axes.text(SMALLEST * 2, 1e8, "textbook: NaN", color=TEXTBOOK)
    axes.loglog(theta, worst(errors.ours, errors.unit), color=LIBRARY, lw=1.3, label="liegen")
    axes.axhline(BOUNDS.get(errors.name, 4.0), color=LINE, lw=0.7, ls="--", label="bound")
    if errors.name in SWITCHES:
        axes.axvline(np.sqrt(SWITCHES[errors.name]), color=LINE, lw=0.7, ls=":", label="switch")
    axes.set_title(TITLES[errors.name], fontsize=8)
    axes.set_xlim(SMALLEST, errors.theta.max())
    axes.set_ylim(FLOOR, CEILING)
    axes.set_yticks([1.0, 1e4, 1e8, 1e12, 1e16])
    axes.minorticks_off()


def draw(path):
    with mpl.rc_context({**mpl.rcParamsDefault, "backend": "Agg", **STYLE}):
        figure, grid = plt.subplots(3, 3, figsize=(10.0, 8.4), sharey=True, layout="constrained")
        measured = [
            *measurement.measure(measurement.STUMPFF, measurement.THETA, angles(100.0).ravel()),
            *measurement.measure(measurement.INVERSE, measurement.THETA, angles(np.pi).ravel()),
            *measurement.measure(measurement.LOG, measurement.W, angles(np.pi).ravel()),
        ]
        for axes, errors in zip(grid.flat, measured, strict=True):
            panel(axes, errors)
        for axes in grid[:, 0]:
            axes.set_ylabel("error, units in the last place")
        for axes in grid[-1]:
            axes.set_xlabel(r"$\theta$, rad")
        handles, labels = grid[1, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4, frameon=False)
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})
        plt.close(figure)


if __name__ == "__main__":
    draw(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).with_suffix(".svg"))
