# SPDX-License-Identifier: Apache-2.0
"""Renders what the camera sees: colour, depth and instance labels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pybullet
from numpy.typing import NDArray

from .scene import CameraConfig


@dataclass(frozen=True)
class Frame:
    """One picture.

    Attributes:
        rgb: uint8, shape (height, width, 3).
        depth: float32, shape (height, width), along the optical axis [m]; 0 where nothing is.
        labels: uint16, shape (height, width), instance labels of the blocks, 0 elsewhere.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    labels: NDArray[np.uint16]


class CameraRenderer:
    """pybullet's CPU renderer behind a pinhole camera."""

    def __init__(self, client: int, config: CameraConfig) -> None:
        self._client = client
        self._config = config
        self._view = pybullet.computeViewMatrix(
            config.position_world, config.target_world, (0.0, 0.0, 1.0)
        )
        self._projection = pybullet.computeProjectionMatrixFOV(
            np.degrees(config.vertical_fov), config.width / config.height, config.near, config.far
        )

    def render(self, labels_by_body: Mapping[int, int]) -> Frame:
        """Renders the world as it is now; ``labels_by_body`` gives a block's label by body id."""
        config = self._config
        _, _, rgba, buffer, bodies = pybullet.getCameraImage(
            config.width,
            config.height,
            self._view,
            self._projection,
            lightDirection=(1.2, -0.6, 1.8),
            lightColor=(1.0, 1.0, 1.0),
            lightAmbientCoeff=0.55,
            lightDiffuseCoeff=0.45,
            lightSpecularCoeff=0.05,
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            physicsClientId=self._client,
        )
        buffer = np.asarray(buffer, dtype=np.float64).reshape(config.height, config.width)
        depth = config.far * config.near / (config.far - (config.far - config.near) * buffer)
        depth[buffer >= 1.0] = 0.0
        bodies = np.asarray(bodies).reshape(config.height, config.width)
        table = np.zeros(max([*labels_by_body, bodies.max(), 0]) + 2, dtype=np.uint16)
        for body, label in labels_by_body.items():
            table[body] = label
        rgba = np.asarray(rgba, dtype=np.uint8).reshape(config.height, config.width, 4)
        return Frame(
            rgb=np.ascontiguousarray(rgba[..., :3]),
            depth=depth.astype(np.float32),
            labels=table[bodies],  # body -1, the background, reads the last entry: 0
        )
