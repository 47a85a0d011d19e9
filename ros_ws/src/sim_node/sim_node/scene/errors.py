# SPDX-License-Identifier: Apache-2.0
"""What a scene description that cannot be built is answered with."""

from __future__ import annotations


class SceneError(ValueError):
    """A scene that is impossible.

    Attributes:
        key: what is wrong, as in ``cameras[0].vertical_fov``; empty for the whole description.
        reason: what is wrong with it, and what is possible.
    """

    def __init__(self, key: str, reason: str, source: str = "") -> None:
        sentence = f"{key} {reason}" if key else reason
        super().__init__(f"{source}: {sentence}" if source else sentence)
        self.key, self.reason = key, reason
