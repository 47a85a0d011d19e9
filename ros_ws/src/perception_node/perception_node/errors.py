# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with perception's inputs; every sentence says what to do about it."""

from __future__ import annotations

from pathlib import Path


class PerceptionError(ValueError):
    """Base class of this package's errors."""


class BadImageError(PerceptionError):
    """An image, segmentation, depth or camera that cannot be used."""


class BlockImageError(BadImageError):
    """One block that cannot be used, by the ``label`` of its mask; the others can be told of."""

    def __init__(self, message: str, label: int) -> None:
        super().__init__(message)
        self.label = label


class UnmeasuredError(BadImageError):
    """A block of which too little depth is known; ``index`` is that of its segment."""

    def __init__(self, message: str, index: int) -> None:
        super().__init__(message)
        self.index = index


class ContradictionError(PerceptionError):
    """Views of two cameras that cannot be of one scene."""


class RobotDescriptionError(PerceptionError):
    """A robot description that is no URDF, or has no shape that could be seen."""


class WeightsError(PerceptionError):
    """A weights file that is missing, damaged or not ours; ``path`` is the file."""

    def __init__(self, message: str, path: Path) -> None:
        super().__init__(message)
        self.path = path


class ClusteringError(PerceptionError):
    """More clusters asked for than there are values, or values that are not numbers."""


class PlacesError(PerceptionError):
    """Stacks that cannot all stand on places."""


class HiddenPlacesError(PlacesError):
    """Something that is no block hides where a stack may stand while places are looked for."""


class DatasetError(PerceptionError):
    """A data set that is missing or not as :mod:`perception_node.training.dataset` describes."""


def with_topics_of(camera: str, sentence: str) -> str:
    """A sentence about the topics of ``camera``, told of those of another one."""
    return sentence.replace("camera/", f"{camera}/")
