# SPDX-License-Identifier: Apache-2.0
"""The network that finds blocks in colour alone: what each pixel is, and where its block's middle.

An encoder and decoder with skips (Ronneberger et al., 2015) on the :class:`FrontView`; blocks are
told apart by the middles that their pixels point at (Cheng et al., 2020), so that two that touch
and have one colour are two.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn
from torch.nn import functional
from torch.nn.utils.fusion import fuse_conv_bn_eval

from perception_node.errors import WeightsError

#: What a pixel is: nothing that matters, a block, or something else that hides the places.
FREE: Final = 0
BLOCK: Final = 1
BEFORE: Final = 2
CLASSES: Final = 3
#: Middles are told as parts of so many pixels.
REACH: Final = 16.0
#: Channels of the input: three colours, and three of where the pixel is, see :func:`where`.
INPUTS: Final = 6
#: Channels at a half, a quarter, … of the input's size.
WIDTHS: Final = (16, 32, 64, 96)

#: Marks a file as ours, in its header.
FORMAT: Final = "tamp masks from colour, version 1"
#: The weights that ship with the package.
DEFAULT_WEIGHTS: Final = Path(__file__).parents[1] / "weights" / "mask_network.safetensors"
_RETRAIN: Final = "train new ones with `make train-masks`"


class MaskNetwork(nn.Module):
    """From views to classes and middles, all of one size."""

    def __init__(self) -> None:
        super().__init__()
        down, channels = [], INPUTS
        for width in WIDTHS:
            down.append(nn.Sequential(*_layer(channels, width, 2), *_layer(width, width)))
            channels = width
        self.down = nn.ModuleList(down)
        up = []
        for width in WIDTHS[-2::-1]:
            up.append(nn.Sequential(*_layer(channels + width, width)))
            channels = width
        self.up = nn.ModuleList(up)
        self.fine = nn.Sequential(*_layer(channels + INPUTS, 16), nn.Conv2d(16, CLASSES + 2, 1))

    def forward(self, views: Tensor) -> tuple[Tensor, Tensor]:
        """Logits of the classes, and the middles' places from each pixel, right and down.

        Args:
            views: shape (n, INPUTS, h, w), sides multiples of 16.

        Returns:
            Shapes (n, CLASSES, h, w) and (n, 2, h, w) [REACH px].
        """
        skips, values = [], views
        for layer in self.down:
            values = layer(values)
            skips.append(values)
        for layer, skip in zip(self.up, skips[-2::-1]):
            values = layer(torch.cat([_doubled(values), skip], 1))
        told = self.fine(torch.cat([_doubled(values), views], 1))
        return told[:, :CLASSES], told[:, CLASSES:]

    def for_inference(self) -> MaskNetwork:
        """This network, made ready to be fast: it cannot be trained or saved any more."""
        self.eval()
        for block in self.modules():
            if isinstance(block, nn.Sequential):
                for i, j in zip(range(len(block) - 1), range(1, len(block))):
                    conv, norm = block[i], block[j]
                    if isinstance(conv, nn.Conv2d) and isinstance(norm, nn.BatchNorm2d):
                        block[i], block[j] = fuse_conv_bn_eval(conv, norm), nn.Identity()
        return self.to(memory_format=torch.channels_last)


def where(feet: Tensor, aside: Tensor, steepness: Tensor, height: int) -> Tensor:
    """Where pixels are: over the foot of the row, beside the nearest place, and seen how steeply.

    Args:
        feet, aside: see :class:`FrontView`, shape (n, w) [px].
        steepness: shape (n,).
        height: h [px].

    Returns:
        Shape (n, 3, h, w), about -1..1.
    """
    n, width = feet.shape
    over = (feet[:, None, :] - torch.arange(height, dtype=feet.dtype)[:, None]) / 100.0
    beside = (aside / 50.0).clamp(-1.5, 1.5)[:, None, :].expand(n, height, width)
    steep = steepness[:, None, None].expand(n, height, width)
    return torch.stack([over, beside, steep], 1)


def predict(
    network: MaskNetwork,
    rgb: NDArray[np.uint8],
    feet: NDArray[np.float32],
    aside: NDArray[np.float32],
    steepness: float,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """What a network says of one view.

    Args:
        rgb: shape (h, w, 3).
        feet, aside, steepness: see :class:`FrontView`.

    Returns:
        Probabilities of the classes, shape (CLASSES, h, w), and middles from each pixel, right and
        down, shape (2, h, w) [px].
    """
    place = where(
        torch.from_numpy(feet)[None],
        torch.from_numpy(aside)[None],
        torch.tensor([steepness], dtype=torch.float32),
        rgb.shape[0],
    )
    colors = torch.from_numpy(np.ascontiguousarray(rgb.transpose(2, 0, 1)))[None].float() / 255.0
    views = torch.cat([colors, place], 1).contiguous(memory_format=torch.channels_last)
    with torch.inference_mode():
        logits, middles = network(views)
        classes = functional.softmax(logits[0], 0)
    return classes.numpy(), REACH * middles[0].numpy()


def save_weights(network: MaskNetwork, path: Path, metadata: Mapping[str, str]) -> None:
    """Writes the weights in half precision; an older file is replaced once the new one is there.

    Args:
        metadata: how they came about, kept in the header.
    """
    tensors = {
        name: value.half().contiguous() if value.is_floating_point() else value.contiguous()
        for name, value in network.state_dict().items()
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    save_file(tensors, partial, metadata={**metadata, "format": FORMAT})
    partial.replace(path)


def load_weights(path: Path = DEFAULT_WEIGHTS) -> MaskNetwork:
    """A network with the weights of a file, ready for inference only; raises WeightsError."""
    return read_weights(path).for_inference()


def read_weights(path: Path) -> MaskNetwork:
    """A network with the weights of a file, as it was when they were saved.

    Raises:
        WeightsError: the file is missing, damaged, or was not made by :func:`save_weights`.
    """
    if not path.is_file():
        raise WeightsError(f"weights file {path} does not exist; {_RETRAIN}", path)
    network = MaskNetwork()
    try:
        with safe_open(path, framework="pt") as file:
            header = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if header.get("format") != FORMAT:
            raise WeightsError(
                f"weights file {path} holds no network for masks from colour; {_RETRAIN}", path
            )
        network.load_state_dict(tensors)
    except (SafetensorError, OSError, ValueError, RuntimeError) as error:
        if isinstance(error, WeightsError):
            raise
        raise WeightsError(
            f"weights file {path} is damaged or of another version ({error}); {_RETRAIN}", path
        ) from error
    if not all(value.isfinite().all() for value in tensors.values()):
        raise WeightsError(
            f"weights file {path} holds values that are not finite; {_RETRAIN}", path
        )
    return network


def _layer(inputs: int, outputs: int, stride: int = 1) -> tuple[nn.Module, ...]:
    conv = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False)
    return conv, nn.BatchNorm2d(outputs), nn.ReLU(inplace=True)


def _doubled(values: Tensor) -> Tensor:
    return functional.interpolate(values, scale_factor=2.0, mode="nearest")
