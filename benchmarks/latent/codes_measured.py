# SPDX-License-Identifier: Apache-2.0
"""What is measured of codes: uniqueness, stability, reconstruction and time."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray
from results_file import Row

from perception_node.latent.state_encoder import StateEncoder

from .bench import TEST_SEED, Bench
from .stability import ALPHAS, changed_by_noise, reconstruction_error, uniqueness


def encoder_rows(bench: Bench, images: int) -> list[Row]:
    """Uniqueness, stability, reconstruction and time of the codes."""
    encoder, rows = bench.encoder, []
    for name, world, label in (
        ("train_5", bench.train, "5 blocks, all states"),
        ("test_4", bench.four, "4 blocks, all states"),
    ):
        codes = bench.codes[name]
        found = uniqueness(codes)
        rows += [
            Row(label, "states whose code no other state has", found.distinct, "", len(codes),
                required="== 1", thesis=1.0),
            Row(label, "bits between the two most similar states", found.nearest, "", len(codes)),
            Row(label, "pictures with the code of their state's first picture", found.same, "",
                codes.shape[0] * (codes.shape[1] - 1)),
        ]  # fmt: skip
        sample = world.images[:: max(1, len(world.images) // images), -1]
        error = reconstruction_error(encoder, sample)
        rows.append(Row(label, "reconstruction error", error, "", len(sample)))
    sample = bench.five.images[:: max(1, len(bench.five.images) // images), 0]
    for alpha in ALPHAS:
        for snapped in (False, True):
            places, codes_changed = changed_by_noise(encoder, sample, alpha, snapped, TEST_SEED)
            kind = "snapped" if snapped else "as encoded"
            bound = "<= 0.01" if snapped and alpha == 0.01 else None
            rows.append(
                Row(
                    f"noise α = {alpha:g}",
                    f"codes changed, {kind}",
                    places,
                    "",
                    len(sample),
                    required=bound,
                    note=f"something changed in {codes_changed:.3f} of the images",
                )
            )
    rows.append(_encoding_time(encoder, bench.five.images[:32, 0]))
    return rows


def _encoding_time(encoder: StateEncoder, images: NDArray[np.uint8]) -> Row:
    seconds = []
    for image in images:
        begun = time.perf_counter()
        encoder.encode(image[None])
        seconds.append(time.perf_counter() - begun)
    spread = (1e3 * min(seconds), 1e3 * max(seconds))
    value = 1e3 * float(np.median(seconds))
    return Row("one image", "encoding and snapping, median", value, "ms", len(images), spread,
               required="<= 50")  # fmt: skip
