# SPDX-License-Identifier: Apache-2.0
"""What training does to the input images: shifts, colours, and damage as of a bad detector.

All of it is self-supervised: the target is the undamaged image at the place where it was put.
"""

from __future__ import annotations

import math
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from .dataset import CROP_SIZE

#: No object is made narrower or lower than this [px].
MIN_SIDE: Final = 5
#: Of how long the longer side of an object in a view of one scale is to be, the visible part of a
#: damaged one included.
ABOUT: Final = (0.75, 1.4)
#: Sine of the greatest angle at which a block that is turned is looked down on, and how bright the
#: darker one of its two sides is at least.
STEEPEST: Final = 0.7
DARKEST: Final = 0.4


def recolored(pixels: Tensor, generator: torch.Generator) -> Tensor:
    """Colours scaled and channels permuted, so that colour says nothing about the place.

    Args:
        pixels: in 0..1, shape (n, 3, h, w).
    """
    n = len(pixels)
    order = torch.rand(n, 3, generator=generator).argsort(1)
    mixed = pixels.gather(1, order[:, :, None, None].expand_as(pixels))
    # A channel that is nearly black everywhere is lifted, as in a block of a brighter colour.
    present = (pixels.sum(1, keepdim=True) > 0).float()
    lift = 0.5 * torch.rand(n, 3, 1, 1, generator=generator)
    gain = 0.5 + 0.6 * torch.rand(n, 1, 1, 1, generator=generator)
    return ((mixed + lift * (pixels.amax(1, keepdim=True))) * gain).clamp(0.0, 1.0) * present


def stretched(
    pixels: Tensor,
    sizes: Tensor,
    factor: float,
    generator: torch.Generator,
    side: int | None = None,
) -> tuple[Tensor, Tensor]:
    """Crops made wider or narrower, and higher or lower, as blocks of other shapes would be.

    Args:
        pixels: in 0..1, shape (n, channels, CROP_SIZE, CROP_SIZE), object at the bottom left.
        sizes: width and height of the objects [px], shape (n, 2).
        factor: by up to which width and height differ; without ``side`` both are divided by up to
            it, and multiplied by up to its root, each by itself.
        side: about how long the longer one becomes, as in views of one scale [px].

    Returns:
        Pixels and sizes.
    """
    if side is None:
        low, high = -math.log(factor), 0.5 * math.log(factor)
        drawn = sizes * torch.exp(low + (high - low) * torch.rand(sizes.shape, generator=generator))
    else:
        ratio = factor ** (2.0 * torch.rand(len(sizes), generator=generator) - 1.0)
        low, high = ABOUT
        longer = side * (low + (high - low) * torch.rand(len(sizes), generator=generator))
        drawn = longer[:, None] * torch.stack([ratio, 1.0 / ratio], 1).clamp(max=1.0)
    wanted = drawn.round().clamp(MIN_SIDE, CROP_SIZE).long()
    ratio = sizes / wanted
    steps = torch.arange(CROP_SIZE) + 0.5
    # Where each pixel comes from, in 0..CROP_SIZE from the left and from the bottom.
    x = steps * ratio[:, :1]
    up = (CROP_SIZE - steps) * ratio[:, 1:]
    outside = (steps[None, :] > wanted[:, :1])[:, None] | (
        (CROP_SIZE - steps)[None, :] > wanted[:, 1:]
    )[:, :, None]
    columns = (2.0 * x / CROP_SIZE - 1.0)[:, None].expand(-1, CROP_SIZE, -1)
    rows = (1.0 - 2.0 * up / CROP_SIZE)[:, :, None].expand(-1, -1, CROP_SIZE)
    grid = torch.stack([columns, rows], -1)
    moved = functional.grid_sample(pixels, grid, mode="nearest", align_corners=False)
    return moved * ~outside[:, None], wanted


def turned(pixels: Tensor, sizes: Tensor, share: float, generator: torch.Generator) -> Tensor:
    """Crops cut as if the blocks were turned about the vertical, up to where two sides are alike.

    Two sides of such a block are seen, which meet in the edge that is nearest: there its outline is
    lowest, and its lower left corner is not on it. The extents stay as they are.

    Args:
        pixels: in 0..1, shape (n, channels, CROP_SIZE, CROP_SIZE), object at the bottom left.
        sizes: width and height of the objects [px], shape (n, 2).
        share: of the objects that are turned.
    """
    n = len(pixels)
    yaw = math.radians(1.0) + math.radians(88.0) * torch.rand(n, 1, 1, generator=generator)
    steep = STEEPEST * torch.rand(n, 1, 1, generator=generator)
    steep = steep * (torch.rand(n, 1, 1, generator=generator) < share)
    width, height = sizes[:, 0, None, None], sizes[:, 1, None, None]
    edge = width / (yaw.cos() + yaw.sin())
    # How far the left and the right side reach across, and how far their outer ends are up.
    left, right = edge * yaw.cos(), edge * yaw.sin()
    most = 0.6 * height / (left + right)
    steep = torch.minimum(steep, most)
    steps = torch.arange(CROP_SIZE) + 0.5
    across, up = steps[None, None, :], (CROP_SIZE - steps)[None, :, None]
    lower = steep * torch.maximum(right * (left - across) / left, left * (across - left) / right)
    upper = height - steep * torch.maximum(
        left * (right - across) / right, right * (across - right) / left
    )
    inside = (up - lower + 0.5).clamp(0.0, 1.0) * (upper - up + 0.5).clamp(0.0, 1.0)
    shade = DARKEST + (1.0 - DARKEST) * torch.rand(n, 2, 1, 1, generator=generator)
    sides = torch.where(across < left, shade[:, 0], shade[:, 1])
    # Over the upper edges of both sides the top is seen, as bright as it was.
    seen = torch.where((steep > 0) & (up < height - steep * (left + right) + lower), sides, 1.0)
    kept = torch.where(steep > 0, inside * seen, 1.0)
    return pixels * kept[:, None]


def damaged(pixels: Tensor, sizes: Tensor, share: float, generator: torch.Generator) -> Tensor:
    """Crops with eroded, holed or partly hidden masks; ``share`` of them are hit by each.

    Args:
        pixels: in 0..1, shape (n, channels, CROP_SIZE, CROP_SIZE), object at the bottom left.
        sizes: width and height of the objects [px], shape (n, 2).
    """
    n = len(pixels)

    def chosen() -> Tensor:
        return (torch.rand(n, 1, 1, 1, generator=generator) < share).float()

    mask = (pixels.amax(1, keepdim=True) > 0).float()
    eroded = 1.0 - functional.max_pool2d(1.0 - functional.pad(mask, (1, 1, 1, 1)), 3, 1)
    ragged = torch.maximum(eroded, mask * (torch.rand(mask.shape, generator=generator) < 0.5))
    pick = chosen()
    keep = pick * ragged + (1 - pick) * mask
    rate = 0.6 * torch.rand(n, 1, 1, 1, generator=generator)
    holes = (torch.rand(mask.shape, generator=generator) > rate).float()
    pick = chosen()
    keep = keep * (pick * holes + (1 - pick))
    # A straight edge hides up to half of the object from one of four sides.
    part = 0.5 * torch.rand(n, 1, 1, generator=generator)
    steps = torch.arange(CROP_SIZE)
    x = (steps[None, None, :] / sizes[:, 0, None, None]).expand(n, CROP_SIZE, CROP_SIZE)
    y = ((CROP_SIZE - 1 - steps)[None, :, None] / sizes[:, 1, None, None]).expand_as(x)
    side = torch.randint(0, 4, (n, 1, 1), generator=generator)
    along = torch.where(side < 2, x, y)
    depth = torch.where(side % 2 == 0, along, 1.0 - along)
    visible = (depth >= part).float()[:, None]
    pick = chosen()
    return pixels * keep * (pick * visible + (1 - pick))


def speckled(images: Tensor, share: float, generator: torch.Generator) -> Tensor:
    """Images in which ``share`` have pixels and small squares that do not belong to the object.

    Args:
        images: in 0..1, shape (n, 3, size, size).
    """
    n, _, size, _ = images.shape
    picked = (torch.rand(n, 1, 1, 1, generator=generator) < share).float()
    rate = 0.02 * torch.rand(n, 1, 1, 1, generator=generator).square()
    specks = (torch.rand(n, 1, size, size, generator=generator) < rate).float()
    coarse = (torch.rand(n, 1, size // 4, size // 4, generator=generator) < 0.25 * rate).float()
    squares = functional.interpolate(coarse, size=(size, size), mode="nearest")
    specks = torch.maximum(specks, squares)
    colors = torch.rand(n, 3, size, size, generator=generator)
    return torch.where(picked * specks > 0, colors, images)
