# SPDX-License-Identifier: Apache-2.0
"""The default segmenter: labels that came with the image, of the detector that 5.2.1 assumes."""

from __future__ import annotations

from perception_node.errors import BadImageError
from perception_node.observation import Observation

from .segments import Segments


def given_labels(observation: Observation) -> Segments:
    """The segments that the observation's own labels show.

    Raises:
        BadImageError: if it has no labels.
    """
    if observation.labels is None:
        raise BadImageError(
            "the image comes without instance labels; give them, or a segmenter that needs none"
        )
    return Segments.from_labels(observation.labels)
