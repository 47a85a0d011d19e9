# SPDX-License-Identifier: Apache-2.0
"""Smooth stand-ins for largest, smallest and absolute values, on the safe side.

The largest of k gaps d_i is smoothed from below by their mean with weights exp(s d_i),

    sum_i d_i exp(s d_i) / sum_i exp(s d_i)  <=  max_i d_i,

which is the largest itself where that stands out, or where all are the same, and whose gradient
does not vanish, so a solver finds the way out of any overlap. The smallest is smoothed from below
by (-1/s) log(sum_i exp(-s d_i)).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import casadi as ca

#: Sharpness s of the smooth maximum [1/m].
SHARPNESS: Final = 150.0
#: Of the smooth minimum over the spheres of a body [1/m].
SHARPNESS_OF_BODIES: Final = 400.0
#: What the safe side costs at most, of four gaps: W(3/e)/s, W being Lambert's function [m].
SMOOTHING: Final = 0.6035 / SHARPNESS


def smooth_abs(value: ca.SX) -> ca.SX:
    """From above, by at most 1 mm."""
    return ca.sqrt(value * value + 1e-6)


def smooth_max(values: Sequence[ca.SX]) -> ca.SX:
    """From below; see the module."""
    gaps = ca.vertcat(*values)
    weights = ca.exp(SHARPNESS * (gaps - ca.mmax(gaps)))
    return ca.dot(gaps, weights) / ca.sum1(weights)


def smooth_min(values: Sequence[ca.SX]) -> ca.SX:
    """From below."""
    return -ca.logsumexp(-SHARPNESS_OF_BODIES * ca.vertcat(*values)) / SHARPNESS_OF_BODIES
