# SPDX-License-Identifier: Apache-2.0
"""The learnt action model M2 on codes (4.2.2): D says which moves there are, π what they lead to.

What π says is snapped to a valid code, and believed only if the inverse move leads back. So a
search on it does not wander among states that cannot be, the known fault of such models.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from scene_graph import Move

from .effect_network import Discriminator, EffectNetwork

#: Packed codes (n, b).
Codes = NDArray[np.uint8]
#: Codes to valid ones, and which of them are.
Snap = Callable[[Codes], tuple[Codes, NDArray[np.bool_]]]

_BATCH = 128


def no_snap(codes: Codes) -> tuple[Codes, NDArray[np.bool_]]:
    """Takes codes as they are."""
    return codes, np.ones(len(codes), np.bool_)


@dataclass(frozen=True)
class Predicted:
    """What moves lead to.

    Attributes:
        codes: shape (n, b).
        valid: which are codes of a picture, shape (n,).
        returns: from which the inverse move leads back, shape (n,).
    """

    codes: Codes
    valid: NDArray[np.bool_]
    returns: NDArray[np.bool_]


class LearntModel:
    """An :class:`.interface.ActionModel` on codes; a state is the bytes of a packed code.

    Args:
        policy, discriminator: π and D.
        moves: the actions, in the networks' order.
        snap: what makes valid codes of predicted ones.
        verify: drop what is no valid code, or from which the inverse move does not lead back.
    """

    def __init__(
        self,
        policy: EffectNetwork,
        discriminator: Discriminator,
        moves: Sequence[Move],
        snap: Snap = no_snap,
        verify: bool = True,
    ) -> None:
        self._policy, self._discriminator = policy.eval(), discriminator.eval()
        self._moves, self._snap, self._verify = tuple(moves), snap, verify
        index = {move: number for number, move in enumerate(self._moves)}
        self._inverse = np.array([index[Move(move.target, move.source)] for move in self._moves])
        self._known: dict[bytes, list[tuple[Move, bytes]]] = {}

    def successors(self, states: Sequence[bytes]) -> list[list[tuple[Move, bytes]]]:
        """See :class:`.interface.ActionModel`."""
        new = [state for state in dict.fromkeys(states) if state not in self._known]
        if new:
            codes = np.stack([np.frombuffer(state, np.uint8) for state in new])
            rows, actions = np.nonzero(self.possible(codes))
            found = self.predict(codes[rows], actions)
            kept = found.valid & found.returns if self._verify else np.ones(len(rows), np.bool_)
            for state in new:
                self._known[state] = []
            for row, action, code, keep in zip(rows, actions, found.codes, kept):
                if keep:
                    self._known[new[row]].append((self._moves[action], code.tobytes()))
        return [self._known[state] for state in states]

    def forget(self) -> None:
        """Forgets the successors of all states that it was asked about."""
        self._known.clear()

    def rolled_out(self, code: NDArray[np.uint8], moves: Sequence[Move]) -> Codes:
        """The codes before and after each of some moves, from one code (b,) -> (n + 1, b)."""
        codes = [code]
        for move in moves:
            action = np.array([self._moves.index(move)])
            codes.append(self._snap(self.raw(codes[-1][None], action))[0][0])
        return np.stack(codes)

    @torch.inference_mode()
    def possible(self, codes: Codes) -> NDArray[np.bool_]:
        """What D says: codes (n, b) -> (n, |A|)."""
        allowed: NDArray[np.bool_] = self._discriminator.possible(self._unpack(codes)).numpy()
        return allowed

    def predict(self, codes: Codes, actions: NDArray[np.int64]) -> Predicted:
        """What π says of codes (n, b) and actions (n,), snapped, and tried the other way round."""
        after, valid = self._snap(self.raw(codes, actions))
        if not self._verify:
            return Predicted(after, valid, np.ones(len(after), np.bool_))
        back, _ = self._snap(self.raw(after, self._inverse[actions]))
        return Predicted(after, valid, (back == codes).all(axis=1))

    @torch.inference_mode()
    def raw(self, codes: Codes, actions: NDArray[np.int64]) -> Codes:
        """What π says, as it says it."""
        parts = [np.zeros((0, codes.shape[1]), np.uint8)]
        for start in range(0, len(codes), _BATCH):
            part = slice(start, start + _BATCH)
            bits = self._policy.after(
                self._unpack(codes[part]), torch.from_numpy(actions[part].astype(np.int64))
            )
            parts.append(np.packbits(bits.numpy().astype(np.bool_), axis=1))
        return np.concatenate(parts)

    def _unpack(self, codes: Codes) -> Tensor:
        return torch.from_numpy(np.unpackbits(codes, axis=1)).float()
