# SPDX-License-Identifier: Apache-2.0
"""The errors of the vocabulary; each carries what failed."""

from __future__ import annotations


class SceneGraphError(ValueError):
    """Base class of everything that can be wrong with a scene graph."""


class InconsistentRelationsError(SceneGraphError):
    """The relations do not describe a set of stacks; ``names`` are the objects concerned."""

    def __init__(self, message: str, names: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.names = names


class ImpossibleMoveError(SceneGraphError):
    """A move that cannot be made in a state; ``source`` and ``target`` are stack indices."""

    def __init__(self, message: str, source: int, target: int) -> None:
        super().__init__(message)
        self.source = source
        self.target = target
