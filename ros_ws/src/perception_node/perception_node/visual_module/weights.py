# SPDX-License-Identifier: Apache-2.0
"""Weights files of the visual module: safetensors, so loading executes nothing from the file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from perception_node.errors import WeightsError

from .coordinate_regressor import BACKBONES
from .object_images import IMAGE_SIZE
from .visual_module import VisualModule

#: Marks a file as ours, in its header.
FORMAT: Final = "tamp visual module G, version 1"
#: The weights that ship with the package.
DEFAULT_WEIGHTS: Final = Path(__file__).parents[1] / "weights" / "visual_module.safetensors"

_RETRAIN: Final = "train new ones with `make train-visual`, or leave the parameter at its default"


def save_weights(module: VisualModule, path: Path, metadata: Mapping[str, str]) -> None:
    """Writes the module's weights; replaces an older file only once the new one is complete.

    Args:
        metadata: how the weights came about (command, commit, data set, …), kept in the header.
    """
    header = {
        **metadata,
        "format": FORMAT,
        "backbone": module.backbone,
        "image_size": str(IMAGE_SIZE),
        "translation_factor": repr(module.translation_factor),
    }
    tensors = {name: value.contiguous() for name, value in module.state_dict().items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    save_file(tensors, partial, metadata=header)
    partial.replace(path)


def read_metadata(path: Path) -> dict[str, str]:
    """The header of a weights file; raises WeightsError."""
    if not path.is_file():
        raise WeightsError(f"weights file {path} does not exist; {_RETRAIN}", path)
    try:
        with safe_open(path, framework="pt") as file:
            metadata = file.metadata() or {}
    except (SafetensorError, OSError, ValueError) as error:
        raise WeightsError(
            f"weights file {path} is damaged or not a safetensors file ({error}); {_RETRAIN}", path
        ) from error
    if metadata.get("format") != FORMAT:
        raise WeightsError(f"weights file {path} holds no weights of module G; {_RETRAIN}", path)
    return metadata


def load_weights(path: Path = DEFAULT_WEIGHTS) -> VisualModule:
    """A module with the weights of a file, ready for inference only; raises WeightsError."""
    return read_weights(path).for_inference()


def read_weights(path: Path) -> VisualModule:
    """A module with the weights of a file, as it was when they were saved.

    Raises:
        WeightsError: if the file is missing, damaged, or was not made by :func:`save_weights`.
    """
    metadata = read_metadata(path)
    try:
        backbone, size = metadata["backbone"], int(metadata["image_size"])
        factor = float(metadata["translation_factor"])
    except (KeyError, ValueError) as error:
        raise WeightsError(f"weights file {path} has a damaged header; {_RETRAIN}", path) from error
    if backbone not in BACKBONES or size != IMAGE_SIZE or not 0.0 < factor <= 2.0:
        raise WeightsError(
            f"weights file {path} is of another version (backbone {backbone!r}, image size {size}, "
            f"factor {factor}); {_RETRAIN}",
            path,
        )
    module = VisualModule(backbone, factor)
    expected = module.state_dict()
    try:
        with safe_open(path, framework="pt") as file:
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError, ValueError) as error:
        raise WeightsError(f"weights file {path} is damaged ({error}); {_RETRAIN}", path) from error
    if {k: v.shape for k, v in tensors.items()} != {k: v.shape for k, v in expected.items()}:
        raise WeightsError(
            f"weights file {path} does not fit backbone {backbone}; {_RETRAIN}", path
        )
    if not all(torch.isfinite(value).all() for value in tensors.values()):
        raise WeightsError(
            f"weights file {path} holds values that are not finite; {_RETRAIN}", path
        )
    module.load_state_dict(tensors)
    return module
