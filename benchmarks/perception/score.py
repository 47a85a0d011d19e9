# SPDX-License-Identifier: Apache-2.0
"""What perception made of a set of pictures, counted."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from results_file import Row, wilson_interval

from perception.answers import BASELINES, SEGMENTERS, Answer
from perception.readings import reading_rows
from perception.sets import PictureSet
from perception_node.segment import RGB
from scene_graph import UNKNOWN

#: Every set whose pictures settle it is held to no more than this share accepted and wrong.
ACCEPTED_WRONG = 0.001


def rows_of(item: PictureSet, answers: Sequence[Answer]) -> list[Row]:
    """The rows of one set."""
    n = len(answers)
    right = sum(answer.right for answer in answers)
    accepted = sum(answer.right and answer.confident for answer in answers)
    wrong = sum(answer.confident and not answer.right for answer in answers)
    seconds = 1000.0 * np.array([answer.seconds for answer in answers])
    iou = [value for answer in answers for value in answer.iou]
    refused = sum(not answer.confident for answer in answers)
    published = [(answer.readings, answer.covered) for answer in answers]
    rows = [
        Row(item.what, "graph right", right / n, "", n, wilson_interval(right, n),
            None if item.graph is None else f">= {item.graph}", item.thesis[0], item.note),
        *_baseline_rows(item, answers, right / n),
        Row(item.what, "accepted and right", accepted / n, "", n, wilson_interval(accepted, n),
            f">= {item.accepted}" if item.graph is not None else None),
        Row(item.what, "accepted and wrong", wrong / n, "", n, wilson_interval(wrong, n),
            f"<= {ACCEPTED_WRONG}" if item.settled else None),
        Row(item.what, "refused with a sentence",
            sum(not answer.confident and bool(answer.message) for answer in answers)
            / max(1, refused), "", refused, None, "== 1.0" if refused else None),
        *_name_rows(item, answers),
        *reading_rows(item.what, published if item.between else []),
        Row(item.what, "IoU, mean", float(np.mean(iou)) if iou else 0.0, "", len(iou), None,
            None if item.iou is None else f">= {item.iou}", item.thesis[1]),
        Row(item.what, "picture to graph, median", float(np.median(seconds)), "ms", n,
            (float(seconds.min()), float(seconds.max()))),
    ]  # fmt: skip
    if item.cameras:
        whole = sum(answer.right and answer.status == "CONFIDENT" for answer in answers)
        rows.append(
            Row(item.what, "right, and nothing hidden", whole / n, "", n, wilson_interval(whole, n))
        )
    if hiding := sum(answer.hides for answer in answers):
        rows.append(Row(item.what, "of these with hidden places", hiding / n, "", n))
    if off := [error for answer in answers for error in answer.place_errors]:
        rows += [
            _error_row(item, "error of places, median", float(np.median(off)), None, n),
            _error_row(item, "error of places, 99th percentile", float(np.percentile(off, 99)),
                       None, n),
        ]  # fmt: skip
    errors = np.array([error for answer in answers for error in answer.errors])
    if not len(errors):
        return rows
    centre, _, yaw = errors.T
    worst = np.percentile(errors, 99, axis=0)
    centre_bound, size_bound = item.sizes or (None, None)
    median_bound, far_bound, yaw_bound = item.poses or (None, None, None)
    far = far_bound if centre_bound is None else centre_bound
    return [
        *rows,
        _error_row(item, "error of centres, median", float(np.median(centre)), median_bound, n),
        _error_row(item, "error of centres, 99th percentile", float(worst[0]), far, n),
        _error_row(item, "error of sizes, 99th percentile", float(worst[1]), size_bound, n),
        _error_row(item, "error of yaw, median", float(np.median(yaw)), yaw_bound, n, "°"),
    ]


def _baseline_rows(item: PictureSet, answers: Sequence[Answer], ours: float) -> list[Row]:
    if not item.baselines:
        return []
    n = len(answers)
    alone = item.mask_source == RGB
    names = tuple(SEGMENTERS if alone else BASELINES)
    rights = [sum(answer.baselines[index] for answer in answers) for index in range(len(names))]
    best = max(rights) / n
    above = names[0] if alone else "the better centroid"
    return [
        *(Row(item.what, f"graph right, {name}", right / n, "", n, wilson_interval(right, n))
          for name, right in zip(names, rights)),
        Row(item.what, f"graph right, above {above} by", ours - best, "", n),
    ]  # fmt: skip


def _name_rows(item: PictureSet, answers: Sequence[Answer]) -> list[Row]:
    blocks = [(answer.confident, *block) for answer in answers for block in answer.named]
    n, rows = len(blocks), []
    if item.names is not None:
        wrong = sum(
            confident and seen not in ("", UNKNOWN, color)
            for confident, color, _, seen, _ in blocks
        )
        unnamed = sum(seen in ("", UNKNOWN) for _, _, _, seen, _ in blocks)
        rows += [
            Row(item.what, "colours wrong with confidence", wrong / n, "", n,
                wilson_interval(wrong, n), f"<= {item.names[0]}"),
            Row(item.what, "colours not named", unnamed / n, "", n,
                wilson_interval(unnamed, n), f"<= {item.names[1]}"),
        ]  # fmt: skip
    if item.shapes is not None:
        right = sum(shape == seen for _, _, shape, _, seen in blocks)
        rows.append(
            Row(item.what, "shapes right", right / n, "", n, wilson_interval(right, n),
                f">= {item.shapes}", 0.97)
        )  # fmt: skip
    return rows


def _error_row(
    item: PictureSet, metric: str, value: float, bound: float | None, n: int, unit: str = "mm"
) -> Row:
    required = None if bound is None else f"<= {bound:g}"
    return Row(item.what, metric, value, unit, n, required=required, note="of accepted graphs")


def refusals(answers: Sequence[Answer]) -> dict[str, int]:
    """How often what was said of graphs that were refused, without names and numbers."""
    return dict(
        Counter(
            f"{answer.status}: {_without_particulars(answer.message)}"
            for answer in answers
            if not answer.confident
        ).most_common()
    )


def _without_particulars(sentence: str) -> str:
    sentence = re.sub(r"\b\w+_(box|cylinder|sphere)(_\d+)?\b", "BLOCK", sentence)
    return re.sub(r"-?\d+(\.\d+)?", "N", sentence)


#: Graphs are sorted by their probability into so many groups of equal size.
_GROUPS: Final = 10


def confidence_rows(seen: Sequence[tuple[PictureSet, Answer]]) -> list[Row]:
    """How well the probability of a graph is calibrated, and what it is good for."""
    told = [(item, answer) for item, answer in seen if item.told and answer.evidence]
    if not told:
        return []
    stated = np.array([answer.probability for _, answer in told])
    right = np.array([answer.right for _, answer in told])
    error = calibration_error(stated, right)
    what, n = "probability of a graph, all sets whose damage can be seen", len(told)
    rows = [Row(what, "calibration error", error, "", n, required="<= 0.02")]
    wrong = stated[~right & np.array([item.damage is None for item, _ in told])]
    threshold = float(wrong.max(initial=0.0))
    ours = [answer for item, answer in told if item.name in ("six", "seven")]
    if ours:
        rejected = sum(answer.probability <= threshold for answer in ours) / len(ours)
        rows.append(
            Row("D_sim, 6 and 7 objects", "rejected at 0 wrong accepted in any undamaged set",
                rejected, "", len(ours), required="<= 0.02", thesis=0.047,
                note=f"{len(wrong)} wrong graphs")
        )  # fmt: skip
    return rows


def calibration_error(stated: NDArray[np.float64], right: NDArray[np.bool_]) -> float:
    """Mean distance of stated probabilities from how often it is so, in groups of equal size.

    Args:
        stated, right: shape (N,).
    """
    order = np.argsort(stated, kind="stable")
    groups = [group for group in np.array_split(order, _GROUPS) if len(group)]
    off = [len(group) * abs(stated[group].mean() - right[group].mean()) for group in groups]
    return float(sum(off) / len(stated))
