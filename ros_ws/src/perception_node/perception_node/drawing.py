# SPDX-License-Identifier: Apache-2.0
"""Draws a scene graph into the camera image: boxes, names, relations, the verdict."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import COLORS, GraphStatus, base_index

from .pipeline import Perceived

#: Least width of the drawing [px]; smaller images are enlarged so that names can be read. At this
#: size an image still fits the 512 kB of Fast DDS's shared memory.
DRAWING_WIDTH: Final = 384

_FONT: Final = cv2.FONT_HERSHEY_SIMPLEX
_FONT_SCALE: Final = 0.38
_HALO: Final = (255, 255, 255)
_CONFIDENT: Final = (20, 130, 40)
_DOUBT: Final = (200, 40, 30)


def draw_scene_graph(rgb: NDArray[np.uint8], perceived: Perceived) -> NDArray[np.uint8]:
    """The image with the graph drawn in, RGB, at least ``DRAWING_WIDTH`` wide.

    Args:
        rgb: the image that was interpreted, shape (height, width, 3).
    """
    graph, status = perceived.graph, perceived.status
    scale = max(1.0, DRAWING_WIDTH / rgb.shape[1])
    size = (round(rgb.shape[1] * scale), round(rgb.shape[0] * scale))
    canvas = cv2.resize(rgb, size, interpolation=cv2.INTER_NEAREST).astype(np.uint8)
    masks = {segment.label: segment.mask for segment in perceived.segments or ()}
    boxes = {
        item.name: _box(masks[item.label], scale) for item in graph.objects if item.label in masks
    }
    for item in graph.objects:
        if item.name not in boxes:
            continue
        left, top, right, bottom = boxes[item.name]
        color = tuple(round(255 * value) for value in COLORS.get(item.color, (1.0, 1.0, 1.0)))
        cv2.rectangle(canvas, (left, top), (right, bottom), (255, 255, 255), 2)
        cv2.rectangle(canvas, (left, top), (right, bottom), color, 1)
        _text(canvas, item.name, (right + 4, (top + bottom) // 2 + 4))
    for relation in sorted(graph.relations):
        if relation.subject in boxes and relation.object in boxes:
            _arrow(canvas, boxes[relation.subject], boxes[relation.object])
        elif relation.subject in boxes and base_index(relation.object) is not None:
            left, _, right, bottom = boxes[relation.subject]
            _text(canvas, relation.object, ((left + right) // 2 - 22, bottom + 14))
    verdict = f"{status.name.replace('_', ' ').lower()}  {graph.confidence:.2f}"
    _text(canvas, verdict, (6, 14), _CONFIDENT if status is GraphStatus.CONFIDENT else _DOUBT)
    for number, line in enumerate(_wrapped(perceived.message, size[0] // 7)):
        _text(canvas, line, (6, 30 + 14 * number), _DOUBT)
    return canvas


def _box(mask: NDArray[np.bool_], scale: float) -> tuple[int, int, int, int]:
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    return (
        int(columns[0] * scale),
        int(rows[0] * scale),
        int((columns[-1] + 1) * scale) - 1,
        int((rows[-1] + 1) * scale) - 1,
    )


def _arrow(
    canvas: NDArray[np.uint8], start: tuple[int, int, int, int], end: tuple[int, int, int, int]
) -> None:
    """From the middle of one box to the middle of another."""
    ends = [((box[0] + box[2]) // 2, (box[1] + box[3]) // 2) for box in (start, end)]
    cv2.arrowedLine(canvas, ends[0], ends[1], (255, 255, 255), 3, cv2.LINE_AA, 0, 0.2)
    cv2.arrowedLine(canvas, ends[0], ends[1], (30, 30, 30), 1, cv2.LINE_AA, 0, 0.2)


def _text(
    canvas: NDArray[np.uint8],
    text: str,
    position: tuple[int, int],
    color: tuple[int, int, int] = (20, 20, 20),
) -> None:
    """Text with a halo, its lower left corner at a position, but not beyond the right border."""
    (width, _), _ = cv2.getTextSize(text, _FONT, _FONT_SCALE, 1)
    x, y = max(min(position[0], canvas.shape[1] - width - 2), 1), position[1]
    for right, down in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        origin = (x + right, y + down)
        cv2.putText(canvas, text, origin, _FONT, _FONT_SCALE, _HALO, 1, cv2.LINE_AA)
    cv2.putText(canvas, text, (x, y), _FONT, _FONT_SCALE, color, 1, cv2.LINE_AA)


def _wrapped(text: str, width: int) -> list[str]:
    lines: list[str] = []
    for word in text.split():
        if lines and len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines
