# SPDX-License-Identifier: Apache-2.0
"""Parts of the code that change by themselves, and the patterns that each of them can have.

Both are found in codes of pictures of which is known only which ones were taken of one state. Bits
that change lie in islands on the latent map: where things can stand, though nobody says so. In each
island some patterns come again and again; what differs from one by less than two pictures of one
state do is taken for it. So a code becomes exactly the same in every picture, and a predicted one a
valid one, without a state having to be known: its parts are, in other states.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

#: Packed codes (n, b).
Codes = NDArray[np.uint8]
Bits = NDArray[np.bool_]

#: A bit that is another one in fewer pictures than this does not count as changing.
_CHANGING: Final = 0.003
#: Patterns seen less often are noise.
_LEAST_SEEN: Final = 2
#: Shares of pairs of pictures of one state within whose distance patterns are one; the first is
#: taken that tells most pictures apart.
_SAME: Final = (0.995, 0.99, 0.98, 0.97)


@dataclass(frozen=True)
class Part:
    """One island.

    Attributes:
        bits: which bits of the code belong to it, as indices, shape (m,).
        patterns: what it can be, shape (k, m).
        radius: bits by which a pattern may differ from one of them.
    """

    bits: NDArray[np.int64]
    patterns: Bits
    radius: int


@dataclass(frozen=True)
class Parts:
    """All islands, and the code around them, which never changes.

    Attributes:
        around: packed, shape (b,); bits that belong to a part mean nothing.
    """

    around: NDArray[np.uint8]
    parts: tuple[Part, ...]

    def snap(self, codes: Codes) -> tuple[Codes, NDArray[np.bool_]]:
        """The nearest code all of whose parts are known patterns, and whether it is near enough."""
        bits = np.unpackbits(codes, axis=1).astype(np.bool_)
        snapped = np.repeat(np.unpackbits(self.around)[None].astype(np.bool_), len(codes), axis=0)
        valid = np.ones(len(codes), np.bool_)
        for part in self.parts:
            nearest, distance = _nearest(bits[:, part.bits], part.patterns)
            snapped[:, part.bits] = part.patterns[nearest]
            valid &= distance <= part.radius
        return np.packbits(snapped, axis=1), valid


def find_parts(codes: NDArray[np.uint8], map_edge: int) -> Parts:
    """The parts of codes (s, r, b): r pictures of each of s states.

    What differs by more than some few pictures of one state do may be one thing or two: as many
    pictures as possible are to have a code that is their state's and no other's.
    """
    found = [_parts_within(codes, map_edge, share) for share in _SAME]
    return max(found, key=lambda parts: _told_apart(parts, codes))


def _told_apart(parts: Parts, codes: NDArray[np.uint8]) -> int:
    """How many pictures have the code of their state's first picture, if no other state's has."""
    snapped = parts.snap(codes.reshape(-1, codes.shape[-1]))[0].reshape(codes.shape)
    _, index, counts = np.unique(snapped[:, 0], axis=0, return_inverse=True, return_counts=True)
    same = (snapped == snapped[:, :1]).all(axis=2).sum(axis=1)
    return int(same[counts[index.ravel()] == 1].sum())


def _parts_within(codes: NDArray[np.uint8], map_edge: int, share_of_pairs: float) -> Parts:
    flat = codes.reshape(-1, codes.shape[-1])
    bits = np.unpackbits(flat, axis=1).astype(np.bool_)
    share = bits.mean(axis=0)
    around = share > 0.5
    changing = np.minimum(share, 1.0 - share) >= _CHANGING
    islands, count = label(changing.reshape(-1, map_edge, map_edge).any(0), np.ones((3, 3)))
    of_bit = np.broadcast_to(islands, (len(share) // islands.size, *islands.shape)).ravel()
    first, second = _pairs_of_one_state(*codes.shape[:2])
    parts = []
    for number in range(1, count + 1):
        chosen = np.flatnonzero((of_bit == number) & changing)
        mine = bits[:, chosen]
        apart = (mine[first] != mine[second]).sum(axis=1)
        radius = max(1, int(np.quantile(apart, share_of_pairs)))
        patterns = _without_aliases(_patterns(mine, radius), mine, first, second)
        if len(patterns) > 1:
            parts.append(Part(chosen, patterns, radius))
        else:
            around[chosen] = patterns[0]
    return Parts(np.packbits(around), tuple(parts))


def _pairs_of_one_state(states: int, renders: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pictures to compare, as indices into all: each to the next one of its state."""
    index = np.arange(states * renders).reshape(states, renders)
    return index.ravel(), np.roll(index, 1, axis=1).ravel()


def _patterns(bits: Bits, radius: int) -> Bits:
    """Patterns (n, m) -> (k, m): the most frequent first, and none within the radius of another.

    Each is then the majority of all that are nearest to it.
    """
    packed = np.packbits(bits, axis=1)
    unique, index, counts = np.unique(packed, axis=0, return_inverse=True, return_counts=True)
    rows = np.unpackbits(unique, axis=1, count=bits.shape[1]).astype(np.bool_)
    order = np.argsort(-counts, kind="stable")
    chosen: list[NDArray[np.bool_]] = []
    for row in order:
        if not chosen or _nearest(rows[row][None], np.stack(chosen))[1][0] > radius:
            chosen.append(rows[row])
    centres = np.stack(chosen)
    nearest, _ = _nearest(rows, centres)
    of_picture = nearest[index.ravel()]
    kept = []
    for number in range(len(centres)):
        mine = bits[of_picture == number]
        if len(mine) >= _LEAST_SEEN:
            kept.append(mine.mean(axis=0) > 0.5)
    return np.unique(np.stack(kept or [centres[0]]), axis=0)


def _without_aliases(
    patterns: Bits, bits: Bits, first: NDArray[np.int64], second: NDArray[np.int64]
) -> Bits:
    """Without patterns whose states mostly show another one in their other pictures.

    The rarest is left out first, since what it stood for may be what keeps another one.
    """
    while len(patterns) > 1:
        nearest, _ = _nearest(bits, patterns)
        together = np.zeros((len(patterns), len(patterns)), np.int64)
        np.add.at(together, (nearest[first], nearest[second]), 1)
        together += together.T
        own = np.diagonal(together).copy()
        np.fill_diagonal(together, -1)
        aliases = np.flatnonzero(own <= together.max(axis=1))
        if not len(aliases):
            break
        patterns = np.delete(patterns, aliases[own[aliases].argmin()], axis=0)
    return patterns


def _nearest(bits: Bits, patterns: Bits) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """For each row the number of the pattern that differs least, and by how many bits."""
    signs, others = (2.0 * b.astype(np.float32) - 1.0 for b in (bits, patterns))
    agreement = signs @ others.T
    nearest = agreement.argmax(axis=1)
    best = agreement[np.arange(len(bits)), nearest]
    return nearest, np.rint(0.5 * (bits.shape[1] - best)).astype(np.int64)
