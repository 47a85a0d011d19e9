# SPDX-License-Identifier: Apache-2.0
"""The oracles of the camera: pybullet's own renderer, and the physics' ray casts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pybullet
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from sim_node.camera import Frame
from sim_node.world import World

#: pybullet casts at most this many rays at once.
BATCH = 16_000
#: Second difference of inverse depth at an edge [1/m].
BEND = 0.004


def tiny_picture(world: World) -> Frame:
    """What pybullet's software renderer sees where the world's camera is."""
    camera = world.config.camera
    view = pybullet.computeViewMatrix(camera.position_world, camera.target_world, (0.0, 0.0, 1.0))
    projection = pybullet.computeProjectionMatrixFOV(
        np.degrees(camera.vertical_fov), camera.width / camera.height, camera.near, camera.far
    )
    _, _, rgba, buffer, bodies = pybullet.getCameraImage(
        camera.width,
        camera.height,
        view,
        projection,
        lightDirection=(1.2, -0.6, 1.8),
        lightColor=(1.0, 1.0, 1.0),
        lightAmbientCoeff=0.55,
        lightDiffuseCoeff=0.45,
        lightSpecularCoeff=0.05,
        shadow=0,
        renderer=pybullet.ER_TINY_RENDERER,
        physicsClientId=world.client,
    )
    depth = camera.far * camera.near / (camera.far - (camera.far - camera.near) * buffer)
    labels = np.zeros(bodies.shape, np.uint16)
    for name in world.names:
        labels[bodies == world.body(name)] = world.label(name)
    return Frame(
        np.asarray(rgba, np.uint8)[..., :3],
        np.where(depth < 0.999 * camera.far, depth, 0.0).astype(np.float32),
        labels,
    )


def rays_of(world: World, step: int = 1) -> tuple[NDArray[Any], tuple[int, int]]:
    """Directions in world through every ``step``-th pixel of every such row, shape (r, 3).

    Of length 1 along the optical axis, so that a hit's distance along its ray is its depth.
    """
    camera = world.config.camera
    rows, columns = np.mgrid[0 : camera.height : step, 0 : camera.width : step]
    pixels = np.stack([columns.ravel(), rows.ravel(), np.ones(rows.size)])
    rays = camera.world_from_optical[:3, :3] @ np.linalg.inv(camera.intrinsics) @ pixels
    return rays.T, rows.shape


def ray_cast(world: World, step: int = 1) -> tuple[NDArray[Any], NDArray[Any]]:
    """Labels and depth [m] by the physics' own rays; they miss its shapes by up to 1 mm."""
    rays, shape = rays_of(world, step)
    far, origin = world.config.camera.far, np.array(world.config.camera.position_world)
    hits = []
    ends = origin + far * rays
    for first in range(0, len(ends), BATCH):
        some = ends[first : first + BATCH]
        starts = np.broadcast_to(origin, some.shape)
        hits += pybullet.rayTestBatch(starts.tolist(), some.tolist(), physicsClientId=world.client)
    label_of = {world.body(name): world.label(name) for name in world.names}
    labels = np.array([label_of.get(hit[0], 0) for hit in hits])
    depth = np.array([far * hit[2] if hit[0] >= 0 else 0.0 for hit in hits])
    return labels.reshape(shape), depth.reshape(shape)


def exact_ray_cast(world: World, step: int = 1) -> tuple[NDArray[Any], NDArray[Any]]:
    """As :func:`ray_cast`, by the equations of the physics' shapes where the physics has them.

    pybullet's rays end within a tolerance of 1 mm of a shape, which is more than is to be shown.
    The arm is left out.
    """
    rays, shape = rays_of(world, step)
    origin = np.array(world.config.camera.position_world)
    labels, nearest = np.zeros(len(rays), int), np.full(len(rays), np.inf)
    label_of = {world.body(name): world.label(name) for name in world.names}
    for index in range(pybullet.getNumBodies(physicsClientId=world.client)):
        body = pybullet.getBodyUniqueId(index, physicsClientId=world.client)
        if body == world.robot:
            continue
        (data,) = pybullet.getCollisionShapeData(body, -1, physicsClientId=world.client)
        position, quaternion = pybullet.getBasePositionAndOrientation(
            body, physicsClientId=world.client
        )
        turn = np.reshape(pybullet.getMatrixFromQuaternion(quaternion), (3, 3))
        depth = _enters(data[2], data[3], (origin - position) @ turn, rays @ turn)
        nearer = depth < nearest
        labels[nearer], nearest[nearer] = label_of.get(body, 0), depth[nearer]
    depth = np.where(nearest < world.config.camera.far, nearest, 0.0)
    return labels.reshape(shape), depth.reshape(shape)


def edges(depth: NDArray[Any]) -> NDArray[np.bool_]:
    """Where depth bends or jumps within a pixel: 1 / depth is linear over every plane."""
    inverse = np.divide(1.0, depth, out=np.zeros(depth.shape), where=depth > 0.0)
    bends = [np.abs(np.diff(inverse, 2, axis=axis)) > BEND for axis in (0, 1)]
    found = np.zeros(depth.shape, bool)
    found[1:-1] |= bends[0]
    found[:, 1:-1] |= bends[1]
    return np.asarray(binary_dilation(found, np.ones((3, 3))))


def _enters(
    kind: int, size: tuple[float, ...], origin: NDArray[Any], rays: NDArray[Any]
) -> NDArray[Any]:
    """How far along each ray a shape around the origin begins; infinite where it is missed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        if kind == pybullet.GEOM_BOX:
            first, last = _slabs(origin, rays, 0.5 * np.array(size))
        elif kind == pybullet.GEOM_SPHERE:
            first, last = _quadric(origin, rays, size[0])
        else:
            first, last = _quadric(origin[:2], rays[:, :2], size[1])
            low, high = _slabs(origin[2:], rays[:, 2:], np.array([0.5 * size[0]]))
            first, last = np.maximum(first, low), np.minimum(last, high)
    return np.where((first <= last) & (first > 0.0), first, np.inf)


def _slabs(
    origin: NDArray[Any], rays: NDArray[Any], half: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Where rays are between pairs of planes: from, to."""
    a, b = (-half - origin) / rays, (half - origin) / rays
    return np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)


def _quadric(
    origin: NDArray[Any], rays: NDArray[Any], radius: float
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Where rays are within a radius of the origin: from, to."""
    a, b = (rays**2).sum(axis=1), rays @ origin
    root = np.sqrt(b**2 - a * (origin @ origin - radius**2))
    first, last = (-b - root) / a, (-b + root) / a
    return np.nan_to_num(first, nan=np.inf), np.nan_to_num(last, nan=-np.inf)
