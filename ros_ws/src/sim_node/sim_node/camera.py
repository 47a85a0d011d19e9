# SPDX-License-Identifier: Apache-2.0
"""Renders what the camera sees: colour, depth and instance labels."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
import pybullet
from numpy.typing import NDArray

from .frame import Frame
from .lens import Lens, Pinhole
from .rendering.rasteriser import Array, Canvas, Triangles, draw
from .rendering.surfaces import Surface, surfaces_of
from .scene import CameraConfig, Light


class CameraRenderer:
    """A camera that looks at the bodies of a physics server.

    What never moves is drawn once. The looks of the others are read once.

    Args:
        client: physics server; in its world there is nothing yet but what never moves.
        config: the camera.
        light: what falls on them.
    """

    def __init__(self, client: int, config: CameraConfig, light: Light | None = None) -> None:
        self._client = client
        self._light = light or Light()
        self._lens = Lens(config) if any(config.distortion) else None
        self._view = self._lens.pinhole if self._lens else Pinhole.of(config)
        self._looks: dict[int, tuple[Surface, ...]] = {}
        self._still = frozenset(self._bodies())
        self.move(config)

    def move(self, config: CameraConfig) -> None:
        """To where the same camera is now."""
        self._config = config
        self._optical_from_world = np.linalg.inv(config.world_from_optical)
        self._backdrop = Canvas.empty(self._view.width, self._view.height)
        self._draw(self._backdrop, self._still, {})

    def render(self, labels_by_body: Mapping[int, int]) -> Frame:
        """Renders the world as it is now; ``labels_by_body`` gives a block's label by body id."""
        canvas = self._backdrop.copy()
        self._draw(
            canvas, [body for body in self._bodies() if body not in self._still], labels_by_body
        )
        shape = (self._view.height, self._view.width)
        inverse = canvas.inverse_depth
        depth = np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0.0)
        depth[depth > self._config.far] = 0.0
        frame = Frame(
            canvas.rgb.reshape(*shape, 3),
            depth.reshape(shape).astype(np.float32),
            canvas.labels.reshape(shape),
        )
        return self._lens.picture(frame) if self._lens else frame

    def forget(self, body: int) -> None:
        """To be told of a body that is taken away: another one may get its number."""
        self._looks.pop(body, None)

    def _bodies(self) -> list[int]:
        count = pybullet.getNumBodies(physicsClientId=self._client)
        return [pybullet.getBodyUniqueId(i, physicsClientId=self._client) for i in range(count)]

    def _draw(self, canvas: Canvas, bodies: Collection[int], labels: Mapping[int, int]) -> None:
        turn, offset = self._optical_from_world[:3, :3], self._optical_from_world[:3, 3]
        eye = np.array(self._config.position_world)
        parts: list[tuple[NDArray[Any], ...]] = []
        vertices = 0
        for body in bodies:
            if body not in self._looks:
                self._looks[body] = surfaces_of(self._client, body)
            surfaces = self._looks[body]
            poses = self._poses(body, [surface.link for surface in surfaces])
            for surface, (rotation, position) in zip(surfaces, poses):
                points = surface.points @ (turn @ rotation).T + (turn @ position + offset)
                seen = np.flatnonzero(surface.faces_to((eye - position) @ rotation))
                marks = np.full(len(seen), labels.get(body, 0), np.uint16)
                shade = _shade(surface.normals[seen], rotation, self._light)
                faces = surface.faces[seen] + vertices
                parts.append((points, faces, shade, surface.colors[seen], marks))
                vertices += len(points)
        if parts:
            triangles = Triangles(*(np.concatenate(part) for part in zip(*parts)))
            draw(canvas, triangles, self._view.intrinsics, self._config.near)

    def _poses(self, body: int, links: list[int]) -> list[tuple[Array, Array]]:
        """Rotations and positions of links in world [m]."""
        client = self._client
        base = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
        moving = sorted({link for link in links if link >= 0})
        poses = {-1: base}
        if moving:
            states = pybullet.getLinkStates(
                body, moving, computeForwardKinematics=1, physicsClientId=client
            )
            poses |= {link: (state[4], state[5]) for link, state in zip(moving, states)}
        return [(_rotation(poses[link][1]), np.array(poses[link][0])) for link in links]


def _rotation(quaternion: tuple[float, ...]) -> Array:
    return np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)


def _shade(normals: Array, rotation: Array, light: Light) -> Array:
    """How bright a surface is at its corners, shape (f, 3).

    Args:
        normals: in the frame of its link, shape (f, 3, 3).
        rotation: of that frame in world, shape (3, 3).
    """
    towards = np.array(light.direction_world) / np.linalg.norm(light.direction_world)
    directions = np.stack([towards @ rotation, rotation[2]], axis=1)
    facing, upward = (normals.reshape(-1, 3) @ directions).T.reshape(2, -1, 3)
    mirrored = np.maximum(2.0 * upward * facing - towards[2], 0.0)
    lit = light.ambient + light.diffuse * np.maximum(facing, 0.0)
    return np.asarray(lit + light.specular * mirrored**2)
