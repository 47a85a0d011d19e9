# SPDX-License-Identifier: Apache-2.0
"""Renders what the camera sees: colour, depth and instance labels."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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


@dataclass(frozen=True)
class _Pixels:
    """What pybullet gives: colours (h, w, 4), its depth buffer (h, w) and body ids (h, w)."""

    rgba: NDArray[np.uint8]
    buffer: NDArray[np.float32]
    bodies: NDArray[np.int32]


class CameraRenderer:
    """pybullet's CPU renderer behind a pinhole camera.

    What never moves is drawn once: it fills most of the picture, and costs more than all the rest.

    Args:
        client: physics server; in its world there is nothing yet but what never moves.
        config: the camera.
        still_bodies: the ids of those bodies; they are not drawn again.
    """

    def __init__(self, client: int, config: CameraConfig, still_bodies: Iterable[int]) -> None:
        self._client = client
        self._config = config
        self._view = pybullet.computeViewMatrix(
            config.position_world, config.target_world, (0.0, 0.0, 1.0)
        )
        self._projection = pybullet.computeProjectionMatrixFOV(
            np.degrees(config.vertical_fov), config.width / config.height, config.near, config.far
        )
        self._backdrop = self._draw()
        self._backdrop_depth = self._depth(self._backdrop.buffer)
        for body in still_bodies:
            # The renderer leaves out what is fully transparent.
            pybullet.changeVisualShape(body, -1, rgbaColor=(0, 0, 0, 0), physicsClientId=client)

    def render(self, labels_by_body: Mapping[int, int]) -> Frame:
        """Renders the world as it is now; ``labels_by_body`` gives a block's label by body id."""
        drawn, backdrop = self._draw(), self._backdrop
        nearer = drawn.buffer < backdrop.buffer
        rgb, depth = backdrop.rgba[..., :3].copy(), self._backdrop_depth.copy()
        rgb[nearer], depth[nearer] = drawn.rgba[nearer, :3], self._depth(drawn.buffer[nearer])
        labels = np.zeros(nearer.shape, dtype=np.uint16)
        bodies = drawn.bodies[nearer]
        label_of = np.zeros(max([*labels_by_body, bodies.max(initial=0)]) + 1, np.uint16)
        for body, label in labels_by_body.items():
            label_of[body] = label
        labels[nearer] = label_of[bodies]
        return Frame(rgb, depth, labels)

    def _depth(self, buffer: NDArray[np.float32]) -> NDArray[np.float32]:
        """Distances along the optical axis [m] for values of the depth buffer; 0 for nothing."""
        near, far = self._config.near, self._config.far
        values = buffer.astype(np.float64)
        return np.where(values < 1.0, far * near / (far - (far - near) * values), 0.0).astype(
            np.float32
        )

    def _draw(self) -> _Pixels:
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
        shape = (config.height, config.width)
        return _Pixels(
            np.asarray(rgba, dtype=np.uint8).reshape(*shape, 4),
            np.asarray(buffer, dtype=np.float32).reshape(shape),
            np.asarray(bodies, dtype=np.int32).reshape(shape),
        )
