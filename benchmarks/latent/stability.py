# SPDX-License-Identifier: Apache-2.0
"""How far codes stay what they are: other pictures of a state, noise, and other states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.latent.state_encoder import StateEncoder

from .prediction import distance

Images = NDArray[np.uint8]
Codes = NDArray[np.uint8]

#: Noise magnitudes α of Figures 4.6 and 4.7; values of images are 0 to 1.
ALPHAS: Final = (0.001, 0.003, 0.005, 0.01, 0.1, 1.0)


@dataclass(frozen=True)
class Uniqueness:
    """Of codes over all states.

    Attributes:
        distinct: share of states whose code no other state has.
        nearest: bits by which the two most similar states' codes differ.
        same: share of pictures whose code is that of the first picture of their state.
    """

    distinct: float
    nearest: int
    same: float


def uniqueness(codes: Codes) -> Uniqueness:
    """By enumeration of all states' codes (s, r, b); a code counts for each state it is seen of."""
    owners: dict[bytes, set[int]] = {}
    for state, rows in enumerate(codes):
        for row in rows:
            owners.setdefault(row.tobytes(), set()).add(state)
    shared = {state for states in owners.values() if len(states) > 1 for state in states}
    first = np.ascontiguousarray(codes[:, 0])
    varying = (first != first[:1]).any(0)
    nearest = min(
        int(np.delete(distance(first[row : row + 1][:, varying], first[:, varying])[0], row).min())
        for row in range(len(first))
    )
    same = (codes == codes[:, :1]).all(2)[:, 1:]
    return Uniqueness(
        1.0 - len(shared) / len(codes), nearest, float(same.mean()) if same.size else 1.0
    )


def noisy(images: Images, alpha: float, seed: int) -> Images:
    """x̃ = x + α·u, u from a standard normal distribution; values 0 to 1, then 255 grey levels."""
    rng = np.random.default_rng([seed, round(alpha * 1e6)])
    values = images / 255.0 + alpha * rng.standard_normal(images.shape)
    return np.asarray(np.rint(np.clip(values, 0.0, 1.0) * 255.0), np.uint8)


def changed_by_noise(
    encoder: StateEncoder, images: Images, alpha: float, snapped: bool, seed: int
) -> tuple[float, float]:
    """Share of places whose code noise changes, and of images of whose code it changes anything."""
    clean = encoder.unpack(encoder.encode(images, snapped))
    other = encoder.unpack(encoder.encode(noisy(images, alpha, seed), snapped))
    differs = (clean != other).any(1)
    return float(differs.float().mean()), float(differs.flatten(1).any(1).float().mean())


def reconstruction_error(encoder: StateEncoder, images: Images, snapped: bool = False) -> float:
    """Mean squared error of decoded codes; values are 0 to 1."""
    errors = []
    for start in range(0, len(images), 256):
        part = images[start : start + 256]
        shown = encoder.decode(encoder.encode(part, snapped))
        errors.append(float(((shown / 255.0 - part / 255.0) ** 2).mean()) * len(part))
    return sum(errors) / len(images)
