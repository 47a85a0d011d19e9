# SPDX-License-Identifier: Apache-2.0
"""Parts of codes: islands of bits that change by themselves, and what each of them can be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perception_node.latent.parts import find_parts

EDGE, BITS = 32, 2
#: Upper left corners of two islands of 5 x 5 places.
CORNERS = ((4, 3), (12, 20))


def patterns_drawn(count: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Patterns of one island, shape (count, BITS, 5, 5)."""
    return rng.random((count, BITS, 5, 5)) < 0.5


def codes_of(
    choice: NDArray[np.int64],
    patterns: list[NDArray[np.bool_]],
    flips: int,
    renders: int,
    rng: np.random.Generator,
) -> NDArray[np.uint8]:
    """Codes (s, r, b) of states that choose a pattern an island; some of its bits are turned."""
    bits = np.zeros((len(choice), renders, BITS, EDGE, EDGE), np.bool_)
    bits[:, :, 0, 30] = True  # something that never changes
    for island, (row, column) in enumerate(CORNERS):
        bits[:, :, :, row : row + 5, column : column + 5] = patterns[island][choice[:, island]][
            :, None
        ]
        for state in range(len(choice)):
            for render in range(renders):
                for _ in range(rng.integers(flips + 1)):
                    place = (
                        rng.integers(BITS),
                        row + rng.integers(5),
                        column + rng.integers(5),
                    )
                    bits[(state, render, *place)] ^= True
    return np.packbits(bits.reshape(len(choice), renders, -1), axis=2)


def test_codes_of_states_never_seen_lose_their_damage() -> None:
    rng = np.random.default_rng(0)
    patterns = [patterns_drawn(6, rng) for _ in CORNERS]
    every = np.array([[a, b] for a in range(6) for b in range(6)])
    seen = rng.permutation(36)[:28]
    unseen = np.setdiff1d(np.arange(36), seen)
    parts = find_parts(codes_of(every[seen], patterns, 2, 6, rng), EDGE)
    assert [len(part.patterns) for part in parts.parts] == [6, 6]
    clean = codes_of(every[unseen], patterns, 0, 1, rng)[:, 0]
    damaged = codes_of(every[unseen], patterns, 2, 1, rng)[:, 0]
    snapped, valid = parts.snap(damaged)
    assert np.array_equal(snapped, clean) and valid.all()


def test_patterns_that_differ_little_are_two_though_some_pictures_are_badly_damaged() -> None:
    rng = np.random.default_rng(3)
    patterns = [patterns_drawn(6, rng) for _ in CORNERS]
    patterns[0][1] = patterns[0][0]
    patterns[0][1, 0, 0, :4] ^= True
    every = np.array([[a, b] for a in range(6) for b in range(6)])
    codes = codes_of(every, patterns, 1, 12, rng)
    bits = np.unpackbits(codes, axis=2).reshape(*codes.shape[:2], BITS, EDGE, EDGE)
    row, column = CORNERS[0]
    bits[[2, 20, 29, 33], 5, 1, row : row + 5, column] ^= 1
    parts = find_parts(np.packbits(bits.reshape(*codes.shape[:2], -1), axis=2), EDGE)
    clean = codes_of(every, patterns, 0, 1, rng)[:, 0]
    snapped, _ = parts.snap(clean)
    assert np.array_equal(snapped, clean)


def test_what_is_far_from_every_pattern_is_told() -> None:
    rng = np.random.default_rng(1)
    patterns = [patterns_drawn(4, rng) for _ in CORNERS]
    every = np.array([[a, b] for a in range(4) for b in range(4)])
    codes = codes_of(every, patterns, 1, 4, rng)
    parts = find_parts(codes, EDGE)
    bits = np.unpackbits(codes[0, 0]).reshape(BITS, EDGE, EDGE)
    bits[:, 4:9, 3:8] ^= 1
    _, valid = parts.snap(np.stack([codes[0, 0], np.packbits(bits)]))
    assert valid.tolist() == [True, False]


def test_bits_around_the_parts_are_put_right() -> None:
    rng = np.random.default_rng(2)
    patterns = [patterns_drawn(4, rng) for _ in CORNERS]
    every = np.array([[a, b] for a in range(4) for b in range(4)])
    codes = codes_of(every, patterns, 1, 4, rng)
    parts = find_parts(codes, EDGE)
    clean = codes_of(every[:1], patterns, 0, 1, rng)[0]
    bits = np.unpackbits(clean[0]).reshape(BITS, EDGE, EDGE)
    bits[1, 31, 31] ^= 1
    assert np.array_equal(parts.snap(np.packbits(bits)[None])[0], clean)


def test_snapping_twice_is_snapping_once() -> None:
    rng = np.random.default_rng(3)
    codes = rng.integers(0, 256, (40, 3, BITS * EDGE * EDGE // 8), dtype=np.uint8)
    parts = find_parts(codes, EDGE)
    once, _ = parts.snap(codes[:, 0])
    assert np.array_equal(parts.snap(once)[0], once)
