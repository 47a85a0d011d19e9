# SPDX-License-Identifier: Apache-2.0
"""What a depth camera makes of exact depths."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from .config import NAN, DepthConfig
from .outlines import moved

if TYPE_CHECKING:
    from sim_node.frame import Frame

Depth = NDArray[np.float32]
Mask = NDArray[np.bool_]
Real = TypeVar("Real", Depth, NDArray[np.float64])

_GREATEST_MILLIMETRES: Final = 65535


def with_depth_errors(frame: Frame, config: DepthConfig, rng: np.random.Generator) -> Frame:
    """A frame as a depth camera sees it; its depth is 0, or NaN where asked for, for none.

    It errs in its own picture, and that is then laid beside the colours.
    """
    lost_random, noise_random = rng.spawn(2)
    lost = drop_outs(frame.depth, config, lost_random)
    depth = noisy(frame.depth, config.noise, config.noise_correlation, noise_random)
    depth = quantised(depth, config.step, config.step_grows)
    depth = shifted(np.where(lost, np.float32(0.0), depth), config.shift)
    nothing = np.nan if config.no_depth == NAN else 0.0
    return replace(frame, depth=np.where(depth <= 0.0, np.float32(nothing), depth))


def noisy(depth: Depth, noise: float, correlation: float, rng: np.random.Generator) -> Depth:
    """Depths with normal errors of σ(z) = noise·z², shape (h, w) [m]; what has none keeps none.

    Args:
        depth: shape (h, w) [m]; 0: none.
        noise: σ at 1 m [m].
        correlation: standard deviation of the Gaussian that neighbours share [px]; whatever it is,
            σ(z) is that of every pixel.
    """
    if noise == 0.0:
        return depth
    height, width = depth.shape
    if correlation == 0.0:
        errors = rng.standard_normal((height, width), np.float32)
    else:
        # Drawn beyond the borders, so that it is as strong there as elsewhere.
        margin = int(np.ceil(3.0 * correlation))
        kernel = cv2.getGaussianKernel(2 * margin + 1, correlation, cv2.CV_32F)
        wide = rng.standard_normal((height + 2 * margin, width + 2 * margin), np.float32)
        inner = np.s_[margin : margin + height, margin : margin + width]
        shared = cv2.sepFilter2D(wide, cv2.CV_32F, kernel, kernel)[inner]
        errors = np.asarray(shared / float((kernel**2).sum()), np.float32)
    return np.maximum(depth + np.float32(noise) * depth**2 * errors, np.float32(0.0))


def quantised(depth: Depth, step: float, grows: bool) -> Depth:
    """Depths in steps, shape (h, w) [m]; what is less than half of the least step is none: 0.

    Args:
        depth: shape (h, w) [m]; 0: none.
        step: 0 for no steps [m].
        grows: then 1/z is a whole multiple of ``step`` (per square metre), which makes steps of
            step·z²; else z is one.
    """
    if step == 0.0:
        return depth
    wide = depth.astype(np.float64)
    if not grows:
        return (np.rint(wide / step) * step).astype(np.float32)
    disparity = np.rint(_inverse(wide) / step) * step
    return _inverse(disparity).astype(np.float32)


def shifted(depth: Depth, shift: tuple[float, float]) -> Depth:
    """Depths beside where they were, shape (h, w) [m]; what comes in from outside is none: 0.

    Args:
        depth: shape (h, w) [m]; 0: none.
        shift: right and down; each pixel has the depth of the one nearest to where it comes from,
            never a mixture of two, and of two equally near ones the farther [px].
    """
    right, down = (int(np.copysign(np.floor(abs(by) + 0.5), by)) for by in shift)
    return moved(depth, down, right) if right or down else depth


def drop_outs(depth: Depth, config: DepthConfig, rng: np.random.Generator) -> Mask:
    """Which pixels lose their depth, shape (h, w)."""
    lost = np.zeros(depth.shape, bool)
    edge_random, any_random = rng.spawn(2)
    if config.edge_dropout > 0.0:
        side = 2 * config.edge_width - 1
        near = depth_edges(depth, config.edge_step).astype(np.uint8)
        near = cv2.dilate(near, np.ones((side, side), np.uint8)).astype(bool)
        lost |= near & (edge_random.random(depth.shape, np.float32) < config.edge_dropout)
    if config.dropout > 0.0:
        lost |= any_random.random(depth.shape, np.float32) < config.dropout
    return lost


def depth_edges(depth: Depth, step: float) -> Mask:
    """Pixels on both sides of where depth jumps, shape (h, w).

    Of neighbours, 1/z differs by more than ``step``: by step·z² in depth. In 1/z a plane has the
    same slope everywhere, so that a threshold tells jumps from planes at any distance.

    Args:
        depth: shape (h, w) [m]; 0: none, which is taken for infinitely far away.
        step: least jump at 1 m [m].
    """
    inverse = _inverse(depth)
    edges = np.zeros(depth.shape, bool)
    for axis in (0, 1):
        jumps = np.abs(np.diff(inverse, axis=axis)) > step
        lower = (slice(None),) * axis + (slice(None, -1),)
        upper = (slice(None),) * axis + (slice(1, None),)
        edges[lower] |= jumps
        edges[upper] |= jumps
    return edges


def millimetres(depth: Depth) -> NDArray[np.uint16]:
    """Depths as 16UC1 has them, shape (h, w) [mm].

    Args:
        depth: shape (h, w) [m]; 0 or NaN: none, which becomes 0, as does what is beyond 65.535 m.
    """
    whole = np.rint(1000.0 * np.nan_to_num(depth.astype(np.float64), nan=0.0, posinf=0.0))
    possible = (whole > 0.0) & (whole <= _GREATEST_MILLIMETRES)
    return np.where(possible, whole, 0.0).astype(np.uint16)


def _inverse(values: Real) -> Real:
    """1/x where x > 0, else 0."""
    return np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0)
