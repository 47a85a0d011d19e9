# SPDX-License-Identifier: Apache-2.0
"""Trains the visual module G self-supervised: eq. 5.3 on crops of rendered scenes, no labels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor

from perception_node.visual_module.coordinate_regressor import DEFAULT_BACKBONE
from perception_node.visual_module.grid_sampler import sample
from perception_node.visual_module.object_images import BLOCK_SIDE, IMAGE_SIZE
from perception_node.visual_module.visual_module import TRANSLATION_FACTOR, VisualModule
from perception_node.visual_module.weights import read_weights

from .augmentation import damaged, recolored, speckled, stretched, turned
from .dataset import ObjectCrops, place_crops
from .objective import reconstruction_loss
from .run import Stateful, TrainingRun


@dataclass(frozen=True)
class TrainingConfig:
    """Hyper-parameters. Table A.1 has batches of 16 images, a rate of 1e-3, the same decay.

    Attributes:
        backbone: of the coordinate regressor.
        imagenet: start from ImageNet weights (5.2.1; ResNets only, needs a network).
        steps: number of batches.
        batch_scenes: scenes a batch.
        learning_rate: peak of a one-cycle schedule.
        weight_decay: of AdamW.
        shift_share: share of objects that are put anywhere in the image; the others are shifted
            together with their scene.
        damage_share: share of inputs hit by each kind of damage; targets are never damaged.
        stretch: by up to this factor width and height of objects are made to differ; what looks at
            them in one scale gets them in about that one, others smaller or larger.
        turn_share: share of objects that are cut as if they were turned.
        bfloat16: autocast of the regressor; faster only where the processor has AMX.
        checkpoint_every: steps between checkpoints.
        seed: of weights, batches and augmentation.
        start: weights to begin with, the path of a file; empty: random ones.
    """

    backbone: str = DEFAULT_BACKBONE
    imagenet: bool = False
    steps: int = 2400
    batch_scenes: int = 6
    learning_rate: float = 2e-3
    weight_decay: float = 1e-4
    translation_factor: float = TRANSLATION_FACTOR
    shift_share: float = 0.7
    damage_share: float = 0.3
    stretch: float = 2.4
    turn_share: float = 0.5
    bfloat16: bool = False
    checkpoint_every: int = 200
    seed: int = 0
    start: str = ""


def bfloat16_helps() -> bool:
    """Whether this processor multiplies bfloat16 faster than float32 (AMX)."""
    try:
        return "amx_bf16" in Path("/proc/cpuinfo").read_text()
    except OSError:
        return False


class Trainer(TrainingRun[float]):
    """One training run of G; each step tells its loss.

    Raises:
        WeightsError: if it is to begin with weights that cannot be read.
    """

    def __init__(self, crops: ObjectCrops, config: TrainingConfig) -> None:
        super().__init__(config, config.steps)
        self.crops = crops
        torch.manual_seed(config.seed)
        self.module = (
            read_weights(Path(config.start))
            if config.start
            else VisualModule(config.backbone, config.translation_factor, config.imagenet)
        )
        self.module.to(memory_format=torch.channels_last)  # a third faster on the CPU
        self.optimizer = torch.optim.AdamW(
            self.module.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay
        )
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(
            self.optimizer, config.learning_rate, total_steps=config.steps, pct_start=0.15
        )
        self._generator = torch.Generator().manual_seed(config.seed)

    @property
    def networks(self) -> tuple[VisualModule]:
        """See :class:`TrainingRun`."""
        return (self.module,)

    @property
    def parts(self) -> Mapping[str, Stateful]:
        """See :class:`TrainingRun`."""
        return {"module": self.module, "optimizer": self.optimizer, "schedule": self.schedule}

    @property
    def generator(self) -> torch.Generator:
        """See :class:`TrainingRun`."""
        return self._generator

    def advance(self) -> float:
        """See :class:`TrainingRun`."""
        inputs, target, default = self._batch()
        scenes, objects = target.shape[:2]
        with torch.autocast("cpu", torch.bfloat16, enabled=self.config.bfloat16):
            phi = self.module.regressor(inputs)
        predicted = sample(default, phi, self.config.translation_factor)
        loss = reconstruction_loss(predicted.unflatten(0, (scenes, objects)), target)
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.module.parameters(), 1.0)
        self.optimizer.step()
        self.schedule.step()
        return float(loss.detach())

    def _batch(self) -> tuple[Tensor, Tensor, Tensor]:
        """Damaged inputs and u_def, shape (n, 3, s, s); targets u_i, (scenes, objects, 3, s, s)."""
        rng, config = self.generator, self.config
        starts = self.crops.scenes
        counts = starts[1:] - starts[:-1]
        # Of scenes with equally many blocks, those of which there are most.
        objects = int(counts.bincount().argmax())
        full = torch.nonzero(counts == objects)[:, 0]
        picked = full[torch.randint(0, len(full), (config.batch_scenes,), generator=rng)]
        index = (starts[picked, None] + torch.arange(objects)).flatten()
        pixels = recolored(self.crops.pixels[index].float() / 255.0, rng)
        side = BLOCK_SIDE if config.backbone == DEFAULT_BACKBONE else None
        pixels, sizes = stretched(pixels, self.crops.sizes[index], config.stretch, rng, side)
        pixels = turned(pixels, sizes, config.turn_share, rng)
        corners = self.crops.corners[index]
        corners = _shifted(corners, sizes, objects, config.shift_share, rng)
        target = place_crops(pixels, corners)
        inputs = place_crops(damaged(pixels, sizes, config.damage_share, rng), corners)
        inputs = speckled(inputs, config.damage_share, rng)
        default = place_crops(pixels, torch.zeros_like(corners))
        inputs = inputs.contiguous(memory_format=torch.channels_last)
        return inputs, target.unflatten(0, (-1, objects)), default


def _shifted(
    corners: Tensor, sizes: Tensor, objects: int, share: float, generator: torch.Generator
) -> Tensor:
    """New corners [px]: scenes shifted as a whole, and ``share`` of the objects put anywhere."""
    room = IMAGE_SIZE - sizes
    grouped = corners.unflatten(0, (-1, objects))
    low = -grouped.amin(1)
    high = (room.unflatten(0, (-1, objects)) - grouped).amin(1)
    draw = torch.rand(low.shape, generator=generator)
    together = (grouped + (low + draw * (high - low + 1)).floor().long()[:, None]).flatten(0, 1)
    anywhere = (torch.rand(room.shape, generator=generator) * (room + 1)).floor().long()
    alone = torch.rand(len(corners), 1, generator=generator) < share
    return torch.where(alone, anywhere, together)
