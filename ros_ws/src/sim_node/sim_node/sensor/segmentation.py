# SPDX-License-Identifier: Apache-2.0
"""What a segmenter makes of exact labels: one kind of error at a time, by name.

An addition is a function in :mod:`.outlines` or :mod:`.confusions`, and its entry here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from .config import EXACT, OFF, SegmentationConfig
from .confusions import merged, missing, phantom, split
from .outlines import Labels, boundary, dilated, eroded, shifted, speckled

if TYPE_CHECKING:
    from sim_node.frame import Frame


class Error(Protocol):
    """A kind of error."""

    def __call__(self, frame: Frame, strength: int, rng: np.random.Generator, /) -> Labels:
        """The labels of an exact frame with the error, shape (h, w); at strength 0 as they are."""
        ...


#: The kinds of errors by name; first those in pixels, then in percent, then in blocks.
ERRORS: Final[Mapping[str, Error]] = {
    "eroded": eroded,
    "dilated": dilated,
    "shifted": shifted,
    "boundary": boundary,
    "speckled": speckled,
    "merged": merged,
    "split": split,
    "missing": missing,
    "phantom": phantom,
}

#: All kinds of segmentation, errors or not.
KINDS: Final = (EXACT, OFF, *ERRORS)


def with_label_errors(frame: Frame, config: SegmentationConfig, rng: np.random.Generator) -> Frame:
    """A frame as a segmenter labels it; whether its labels are published is another matter."""
    if config.is_exact:
        return frame
    return replace(frame, labels=ERRORS[config.kind](frame, config.strength, rng))
