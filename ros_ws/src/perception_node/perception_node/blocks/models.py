# SPDX-License-Identifier: Apache-2.0
"""Models of blocks: what a camera sees of upright boxes, cylinders and balls.

A block is a vector of P parameters, among them extents; all lengths in m, frame world. Functions
take those of B blocks at once: blocks are few, and numpy's calls are what takes time.
"""

from __future__ import annotations

from typing import Final, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, CYLINDER, SPHERE

Array = NDArray[np.float64]

#: A cylinder's rim and a ball's outline are polygons of so many corners.
CORNERS: Final = 24
#: How far a block's surface is from the model's, apart from noise: rounded edges, calibration [m].
MODEL_NOISE: Final = 3e-4

_UNIT: Final = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (0.0, 1.0)])
_TURNS: Final = np.arange(CORNERS) * (2.0 * np.pi / CORNERS)
#: Half way between an inscribed and a circumscribed polygon.
CIRCLE: Final = np.stack([np.cos(_TURNS), np.sin(_TURNS)], axis=-1) * (
    0.5 + 0.5 / np.cos(np.pi / CORNERS)
)


class Seen(NamedTuple):
    """What was measured of B blocks, N points each.

    Attributes:
        origin: the camera's centre in world, shape (3,) [m].
        points: that were measured, shape (B, N, 3) [m].
        rays: directions of their pixels, of length 1 along the optical axis, shape (B, N, 3).
        noise: standard deviations of their depths, shape (B, N) [m].
        floor: standard deviation of a surface about its model [m].
    """

    origin: Array
    points: Array
    rays: Array
    noise: Array
    floor: float = MODEL_NOISE

    def of(self, chosen: NDArray[np.bool_]) -> Seen:
        """Some of the n points of one block, whose arrays have no first axis, as those of B = 1."""
        points, rays, noise = (item[None, chosen] for item in (self.points, self.rays, self.noise))
        return Seen(self.origin, points, rays, noise, self.floor)


class Surface(NamedTuple):
    """How far points are outside of the faces that their rays meet.

    Attributes:
        off: distances, shape (B, N) [m].
        doubt: their standard deviations, shape (B, N) [m].
        slopes: derivatives of the distances by the parameters, shape (B, N, P).
    """

    off: Array
    doubt: Array
    slopes: Array


class Model(Protocol):
    """A kind of block."""

    shape: str
    #: Steps for derivatives of the outline, one a parameter, in its unit.
    steps: Array
    #: Which parameters are extents, and between what they are [m].
    extents: list[int]
    narrowest: float
    widest: float

    def outline(self, parameters: Array, origin: Array) -> Array:
        """Points whose convex hull in the picture is a block's outline, (..., P) -> (..., n, 3)."""
        ...

    def surface(self, parameters: Array, seen: Seen) -> Surface:
        """How points lie about the faces of their blocks; ``parameters`` of shape (B, P)."""
        ...

    def hidden(self, parameters: Array, origin: Array) -> Array:
        """Directions in which an extent grows where it may be hidden, what is seen staying.

        Args:
            parameters: shape (B, P).

        Returns:
            Shape (d, B, P).
        """
        ...


class BoxModel:
    """Upright box: x, y of its axis, yaw, two widths, z of its lower and upper end."""

    shape = BOX
    steps = np.array([1e-4, 1e-4, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4])
    extents, narrowest, widest = [3, 4], 0.01, 0.12

    def outline(self, parameters: Array, origin: Array) -> Array:  # noqa: ARG002
        """See :class:`Model`."""
        x, y, yaw, along, across, low, high = np.moveaxis(parameters, -1, 0)[..., None]
        a, b, up = (_UNIT[:, 0] * along, _UNIT[:, 1] * across, low + _UNIT[:, 2] * (high - low))
        c, s = np.cos(yaw), np.sin(yaw)
        return np.stack([x + c * a - s * b, y + s * a + c * b, up], axis=-1)

    def surface(self, parameters: Array, seen: Seen) -> Surface:
        """See :class:`Model`."""
        x, y, yaw, along, across, _low, high = parameters.T[..., None]
        c, s = np.cos(yaw), np.sin(yaw)
        dx, dy = seen.points[..., 0] - x, seen.points[..., 1] - y
        met = _Met(seen, 7)
        met.lid(high, 6)
        for index, (a, b, width) in enumerate(((c, s, along), (-s, c, across))):
            begin = a * (seen.origin[0] - x) + b * (seen.origin[1] - y)
            place = a * dx + b * dy
            # The face towards the camera; from between two opposite ones the nearer to the point.
            side = np.where(np.abs(begin) > 0.5 * width, np.sign(begin), np.sign(place))
            step = a * seen.rays[..., 0] + b * seen.rays[..., 1]
            slopes = {0: -side * a, 1: -side * b, 2: side * (a * dy - b * dx), 3 + index: -0.5}
            met.face(side * place - 0.5 * width, side * step, slopes, 0.5 * width - side * begin)
        return met.surface()

    def hidden(self, parameters: Array, origin: Array) -> Array:
        """See :class:`Model`."""
        x, y, yaw = parameters.T[:3]
        c, s = np.cos(yaw), np.sin(yaw)
        directions = np.zeros((3, *parameters.shape))
        directions[2, :, 6] = 1.0  # the lid, under a block that stands on it
        for row, (a, b) in enumerate(((c, s), (-s, c))):
            back = -0.5 * np.sign(a * (origin[0] - x) + b * (origin[1] - y))
            directions[row, :, 0], directions[row, :, 1] = back * a, back * b
            directions[row, :, 3 + row] = 1.0
        return directions


class CylinderModel:
    """Upright cylinder: x, y of its axis, radius, z of its lower and upper end."""

    shape = CYLINDER
    steps = np.array([1e-4, 1e-4, 1e-4, 1e-4, 1e-4])
    extents, narrowest, widest = [2], 0.005, 0.06

    def outline(self, parameters: Array, origin: Array) -> Array:  # noqa: ARG002
        """See :class:`Model`."""
        x, y, radius, low, high = np.moveaxis(parameters, -1, 0)[..., None]
        a, b = x + radius * CIRCLE[:, 0], y + radius * CIRCLE[:, 1]
        ends = [np.stack([a, b, np.broadcast_to(z, a.shape)], axis=-1) for z in (low, high)]
        return np.concatenate(ends, axis=-2)

    def surface(self, parameters: Array, seen: Seen) -> Surface:
        """See :class:`Model`."""
        x, y, radius, _low, high = parameters.T[..., None]
        dx, dy = seen.points[..., 0] - x, seen.points[..., 1] - y
        from_axis = np.maximum(np.hypot(dx, dy), 1e-6)
        rays = seen.rays
        step = (dx * rays[..., 0] + dy * rays[..., 1]) / from_axis
        ox, oy = seen.origin[0] - x, seen.origin[1] - y
        a = np.maximum(rays[..., 0] ** 2 + rays[..., 1] ** 2, 1e-9)
        b = rays[..., 0] * ox + rays[..., 1] * oy
        meets = (-b - np.sqrt(np.maximum(b * b - a * (ox**2 + oy**2 - radius**2), 0.0))) / a
        inwards = np.minimum(step, -1e-9)
        met = _Met(seen, 5)
        met.lid(high, 4)
        slopes = {0: -dx / from_axis, 1: -dy / from_axis, 2: -1.0}
        met.face(from_axis - radius, inwards, slopes, meets * inwards)
        return met.surface()

    def hidden(self, parameters: Array, origin: Array) -> Array:  # noqa: ARG002
        """See :class:`Model`: the lid, under a block that stands on it."""
        directions = np.zeros((1, *parameters.shape))
        directions[0, :, 4] = 1.0
        return directions


class BallModel:
    """Ball: x, y, z of its centre, radius."""

    shape = SPHERE
    steps = np.array([1e-4, 1e-4, 1e-4, 1e-4])
    extents, narrowest, widest = [3], 0.005, 0.06

    def outline(self, parameters: Array, origin: Array) -> Array:
        """See :class:`Model`."""
        centre, radius = parameters[..., :3], parameters[..., 3:]
        toward = origin - centre
        distance = np.linalg.norm(toward, axis=-1, keepdims=True)
        toward = toward / distance
        shift = radius**2 / distance
        rim = radius * np.sqrt(np.maximum(1.0 - (radius / distance) ** 2, 0.0))
        side = np.cross(toward, [0.0, 0.0, 1.0])
        side /= np.linalg.norm(side, axis=-1, keepdims=True)
        up = np.cross(side, toward)
        circle = CIRCLE[:, 0, None] * side[..., None, :] + CIRCLE[:, 1, None] * up[..., None, :]
        return (centre + shift * toward)[..., None, :] + rim[..., None, :] * circle

    def surface(self, parameters: Array, seen: Seen) -> Surface:
        """See :class:`Model`."""
        away = seen.points - parameters[:, None, :3]
        from_centre = np.maximum(np.linalg.norm(away, axis=-1), 1e-6)
        normal = away / from_centre[..., None]
        slopes = np.concatenate([-normal, np.full((*from_centre.shape, 1), -1.0)], axis=-1)
        step = np.einsum("bni,bni->bn", normal, seen.rays)
        return Surface(
            from_centre - parameters[:, 3:], _doubt(seen.noise, step, seen.floor), slopes
        )

    def hidden(self, parameters: Array, origin: Array) -> Array:  # noqa: ARG002
        """See :class:`Model`: none, as the front tells the radius."""
        return np.zeros((0, *parameters.shape))


class _Met:
    """The faces of a convex block, and which of them each point is of.

    Of the faces that its ray enters by, that which it meets last; but a point that is outside of
    another one, too, by more, counts as much: models that are too small are pulled out to it.
    """

    def __init__(self, seen: Seen, parameters: int) -> None:
        self._seen = seen
        self._faces: list[tuple[Array, Array, dict[int, Array | float]]] = []
        self._which = np.zeros(seen.noise.shape, np.intp)
        self._last = np.full(seen.noise.shape, -np.inf)
        self._parameters = parameters

    def face(
        self, off: Array, step: Array, slopes: dict[int, Array | float], distance: Array
    ) -> None:
        """A face, the first one such that points of no other are of it.

        Args:
            off: how far the points are outside of it, shape (B, N) [m].
            step: cosine between its normal, outwards, and the rays, times their length, (B, N).
            slopes: derivatives of ``off`` by those parameters on which it depends.
            distance: of its plane from the camera along the normal, shape (B, 1) or (B, N) [m].
        """
        meets = distance / np.minimum(step, -1e-9)
        later = (meets > self._last) & (step < 0.0)
        self._which[later] = len(self._faces)
        self._last = np.where(later, meets, self._last)
        self._faces.append((off, _doubt(self._seen.noise, step, self._seen.floor), slopes))

    def lid(self, high: Array, index: int) -> None:
        """The upper face, whose height is the parameter ``index``, shape (B, 1) [m]."""
        points, rays = self._seen.points[..., 2], self._seen.rays[..., 2]
        self.face(points - high, rays, {index: -1.0}, high - self._seen.origin[2])

    def surface(self) -> Surface:
        """How the points lie about the faces that they are of."""
        off = np.stack([face[0] for face in self._faces])
        doubt = np.stack([np.broadcast_to(face[1], off.shape[1:]) for face in self._faces])
        which = self._which
        mine = np.abs(np.take_along_axis(off / doubt, which[None], axis=0)[0])
        outside = off / doubt
        worst = outside.argmax(axis=0)
        which = np.where(outside.max(axis=0) > mine, worst, which)
        slopes = np.zeros((*which.shape, self._parameters))
        for number, (_, _, by_parameter) in enumerate(self._faces):
            chosen = which == number
            for index, slope in by_parameter.items():
                slopes[..., index] += np.where(chosen, slope, 0.0)
        return Surface(
            np.take_along_axis(off, which[None], axis=0)[0],
            np.take_along_axis(doubt, which[None], axis=0)[0],
            slopes,
        )


def _doubt(noise: Array, share: Array, floor: float) -> Array:
    """Standard deviation of the distance from a face that a ray meets at an angle [m].

    Args:
        noise: of the depth along the ray, shape (B, N) [m].
        share: cosine between the ray and the face's normal, shape (B, N).
        floor: what is added to it whatever the angle [m].
    """
    return np.hypot(noise * share, floor)
