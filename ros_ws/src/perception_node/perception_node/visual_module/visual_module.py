# SPDX-License-Identifier: Apache-2.0
"""The visual module G: coordinate regressor π and affine grid sampler ρ (5.2.1, A.2.1)."""

from __future__ import annotations

from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from perception_node.segment import Segments

from .coordinate_regressor import DEFAULT_BACKBONE, PointingRegressor, make_regressor
from .coordinates import Coordinates, translated_overlap
from .grid_sampler import pixels_from_coordinates, sample
from .near_content import NearContent
from .object_images import IMAGE_SIZE, ObjectImages, object_images, object_views

#: Factor of the matrix α; 2 lets φ in 0..1 reach the whole image, where the thesis has 1.6.
TRANSLATION_FACTOR: Final = 2.0


class VisualModule(nn.Module):
    """G: from images of single objects to coordinates, and back to images."""

    def __init__(
        self,
        backbone: str = DEFAULT_BACKBONE,
        translation_factor: float = TRANSLATION_FACTOR,
        imagenet: bool = False,
    ) -> None:
        super().__init__()
        self.backbone = backbone
        self.translation_factor = translation_factor
        self.regressor = make_regressor(backbone, imagenet)

    def forward(self, images: Tensor, default: Tensor) -> tuple[Tensor, Tensor]:
        """φ = π(u_i) and ũ_i = ρ(φ, u_i^def).

        Args:
            images: u_i in 0..1, shape (n, 3, size, size).
            default: u_i^def, shape (n, channels, size, size).

        Returns:
            φ, shape (n, 2), and ũ_i, the shape of ``default``.
        """
        phi = self.regressor(images)
        return phi, sample(default, phi, self.translation_factor)

    def for_inference(self) -> VisualModule:
        """This module, made ready to be fast: it cannot be trained or saved any more."""
        self.eval()
        for block in self.modules():
            if isinstance(block, nn.Sequential):
                _fold_normalisation(block)
        self.to(memory_format=torch.channels_last)
        if isinstance(self.regressor, PointingRegressor):
            self.regressor = NearContent(self.regressor, IMAGE_SIZE)
        return self

    def images(self, rgb: NDArray[np.uint8], segments: Segments) -> ObjectImages:
        """Views of the objects at one scale, or of the whole scene for what knows places only."""
        scale_free = self.backbone == DEFAULT_BACKBONE
        return (object_views if scale_free else object_images)(rgb, segments)

    @torch.inference_mode()
    def locate(self, objects: ObjectImages) -> Coordinates:
        """Coordinates of all objects of a scene, in one batch. Call ``eval()`` first."""
        if len(objects) == 0:
            empty = np.zeros((0, 2))
            return Coordinates(empty, empty, empty, np.zeros(0))
        images = torch.from_numpy(objects.images)
        phi = self.regressor(images)
        size = images.shape[-1]
        moved = pixels_from_coordinates(phi, size, self.translation_factor)
        corners = objects.in_scene(moved.double().numpy() / size)
        centres = moved.double().numpy() / size + 0.5 * objects.crop_sizes / size
        return Coordinates(
            phi=np.clip(2.0 / self.translation_factor * corners, 0.0, 1.0),
            corners=corners,
            centres=objects.in_scene(centres),
            iou=translated_overlap(
                objects.coverage,
                objects.default_coverage,
                objects.crop_sizes,
                moved.double().numpy(),
            ),
        )


def _fold_normalisation(block: nn.Sequential) -> None:
    """Puts the scale and shift of batch normalisation into the convolution before it."""
    for index in range(len(block) - 1):
        first, second = block[index], block[index + 1]
        if isinstance(first, nn.Conv2d) and isinstance(second, nn.BatchNorm2d):
            block[index] = fuse_conv_bn_eval(first, second)
            block[index + 1] = nn.Identity()
