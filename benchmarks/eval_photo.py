# SPDX-License-Identifier: Apache-2.0
"""``make eval-photo``: graphs of photorealistic pictures, as D_pbw of the thesis (5.3).

Blender renders blocks of rubber and metal with rounded edges on a table, in soft light from warm to
cool (seeds from 1000); perception, trained on the simulator's plain pictures only, interprets them,
masks found. Pictures are kept in ``data/photo``: stopped, the same command goes on. ``BPY=`` names
a virtual environment with the wheel ``bpy``. Writes ``benchmarks/results/photo.json``.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Final

import torch
from perception.answers import Answer, answer_to
from perception.scenes import plain
from perception.score import refusals, rows_of
from perception.sets import REAL_DEPTH, PictureSet
from photo.render import BlenderError, photographs
from results_file import Row, print_rows, quick, write_result
from tqdm import tqdm

from perception_node import load_weights
from perception_node.calibration import View
from sim_node import SensorConfig, sense

#: Thesis: trained on D_pbw with 5 objects. Ours has seen no picture of Blender.
SET: Final = PictureSet(
    "photo", "D_pbw, 6 objects, trained on D_sim alone", plain(6), 2000,
    graph=0.97, iou=0.90, thesis=(0.889, 0.740),
)  # fmt: skip
NOISY: Final = replace(
    SET,
    name="photo_noisy",
    what="D_pbw, 6 objects, depth of a real camera, trained on D_sim alone",
    sensor=SensorConfig(depth=REAL_DEPTH),
    iou=None,
    thesis=(None, None),
)


def main() -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C, 2 when it cannot start."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, help="pictures at most")
    parser.add_argument("--bpy", type=Path, help="virtual environment with bpy")
    parser.add_argument("--data", type=Path, default=Path("data/photo"), help="folder of pictures")
    parser.add_argument("--threads", type=int, default=2, help="of Blender")
    options = parser.parse_args()
    torch.set_num_threads(1)
    begun = time.perf_counter()
    count = min(SET.count, options.n or (20 if quick() else SET.count))
    try:
        answers = _answers(options, count)
    except BlenderError as error:
        print(f"cannot evaluate: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; the same command goes on from there")
        return 130
    rows: list[Row] = []
    for item, given in answers.items():
        rows += rows_of(item, given)
    print_rows(rows)
    details = {
        "refused": {item.what: refusals(given) for item, given in answers.items()},
        "accepted and wrong, seeds": {
            item.what: [answer.seed for answer in given if answer.confident and not answer.right]
            for item, given in answers.items()
        },
    }
    command = f"make eval-photo N={count} BPY=/path/to/venv"
    print(write_result("photo", command, rows, time.perf_counter() - begun, details))
    return 0


def _answers(options: argparse.Namespace, count: int) -> dict[PictureSet, list[Answer]]:
    locator = load_weights()
    drawn = [SET.draw(number) for number in range(count)]
    answers: dict[PictureSet, list[Answer]] = {SET: [], NOISY: []}
    photos = photographs(options.data, drawn, options.bpy, options.threads)
    for item, photo in tqdm(zip(drawn, photos), total=count, unit="picture", desc="photo"):
        for chosen, given in answers.items():
            frame = sense(photo.frame, chosen.sensor, (item.seed, 0, 0))
            observation = View(photo.camera).observation(frame.rgb, frame.labels, frame.depth)
            answer, _ = answer_to(item.seed, observation, photo.truth, chosen, locator)
            given.append(answer)
    return answers


if __name__ == "__main__":
    raise SystemExit(main())
