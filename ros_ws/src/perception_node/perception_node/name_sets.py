# SPDX-License-Identifier: Apache-2.0
"""Sets of colours that hold the right ones in a stated share of scenes: split conformal prediction.

How badly the colours c of a scene's N blocks fit is s(c) = max_i gap_i(c_i), the gaps those of
:class:`.light.ColorFit`. With s of the right colours in n scenes of a kind, drawn for this alone,
and q the ⌈(n + 1)·coverage⌉-th smallest of them, the colours of another scene of the kind have
s <= q in at least that share of all scenes: the set is the product of {c : gap_i(c) <= q} over the
blocks (Papadopoulos et al. 2002). Where all colours are certain there is one reading, and s is
infinite where that is wrong.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import COLORS

from .light import MIN_MARGIN, ColorFit, explain_colors

Array = NDArray[np.float64]

PARAMETERS: Final = Path(__file__).parent / "weights" / "name_sets.json"
_NAMES: Final = tuple(COLORS)
#: A colour further than this from all names is none of them, nor between two [ΔE].
MAX_BETWEEN: Final = 24.0
#: A block that may have more colours than so many, and a scene in which so many blocks are in
#: doubt, say nothing that helps.
MOST_COLORS: Final = 3
MOST_BLOCKS: Final = 2
#: So many blocks have to be certain: they tell the light.
LEAST_CERTAIN: Final = 2
#: In a light whose gain of red or blue over green is further from 1, colours that are between two
#: may be plain ones; logarithm.
MOST_TINT: Final = 0.12


@dataclass(frozen=True)
class NameSets:
    """What was found on scenes drawn for it.

    Attributes:
        coverage: share of scenes whose colours are in their sets, at least.
        threshold: q [ΔE].
    """

    coverage: float
    threshold: float


def load_name_sets(path: Path = PARAMETERS) -> NameSets:
    """Those that ``benchmarks/fit_name_sets.py`` wrote."""
    content = json.loads(path.read_text())
    return NameSets(float(content["coverage"]), float(content["threshold"]))


def conformal_threshold(scores: Sequence[float], coverage: float) -> float:
    """The ⌈(n + 1)·coverage⌉-th smallest of n scores; infinite where there are too few."""
    rank = math.ceil((len(scores) + 1) * coverage)
    return sorted(scores)[rank - 1] if rank <= len(scores) else math.inf


def in_doubt(fit: ColorFit, colors: Array, table: Array | None) -> NDArray[np.bool_] | None:
    """Which of N blocks are in doubt while nothing else is, shape (N,).

    Args:
        fit: of ``colors``.
        colors, table: see :func:`.light.explain_colors`.

    Returns:
        None where the doubt is not about few blocks between known colours: the others have to be
        certain of theirs without these as well, for in a light that nobody knows all are wrong.
    """
    sure = fit.known & (fit.margins >= MIN_MARGIN)
    if (~sure).sum() > MOST_BLOCKS or sure.sum() < LEAST_CERTAIN:
        return None
    if (fit.distances[~sure] > MAX_BETWEEN).any():
        return None
    rest = explain_colors(colors[sure], table)
    named = tuple(name for name, certain in zip(fit.names, sure) if certain)
    if rest.names != named or not (rest.known & (rest.margins >= MIN_MARGIN)).all():
        return None
    if (np.abs(np.log(rest.light)) > MOST_TINT).any():
        return None
    return ~sure


def possible_colors(
    fit: ColorFit, colors: Array, table: Array | None, threshold: float
) -> tuple[tuple[str, ...], ...] | None:
    """The colours that each of N blocks may have, the likeliest first; one where it is certain.

    Args:
        fit, colors, table: see :func:`in_doubt`.
        threshold: q [ΔE].

    Returns:
        None where the doubt is not about few colours of few blocks.
    """
    doubtful = in_doubt(fit, colors, table)
    if doubtful is None:
        return None
    sets = [(name,) for name in fit.names]
    for index in np.flatnonzero(doubtful):
        order = np.argsort(fit.gaps[index], kind="stable")
        # Two at least: what is not certain is never told as if it were.
        count = max(2, int((fit.gaps[index] <= threshold).sum()))
        if count > MOST_COLORS:
            return None
        sets[index] = tuple(_NAMES[item] for item in order[:count])
    return tuple(sets)
