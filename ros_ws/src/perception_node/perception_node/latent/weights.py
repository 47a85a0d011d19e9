# SPDX-License-Identifier: Apache-2.0
"""Weights files of the state encoder: safetensors, so loading executes nothing from the file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Final

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor

from perception_node.errors import WeightsError

from .parts import Part, Parts
from .state_encoder import EncoderConfig, StateEncoder

#: Marks a file as ours, in its header.
FORMAT: Final = "tamp state encoder G, version 1"

#: The weights that ship with the package.
DEFAULT_ENCODER: Final = Path(__file__).parents[1] / "weights" / "state_encoder.safetensors"
_PARTS: Final = "parts."

_RETRAIN: Final = "train new ones with `make train-latent`"


def save_encoder(encoder: StateEncoder, path: Path, metadata: Mapping[str, str]) -> None:
    """Writes the weights; replaces an older file only once the new one is complete.

    Args:
        metadata: how they came about, kept in the header.
    """
    header = {**metadata, "format": FORMAT, "config": json.dumps(asdict(encoder.config))}
    tensors = {name: value.contiguous() for name, value in encoder.state_dict().items()}
    tensors |= _tensors_of(encoder.parts)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    save_file(tensors, partial, metadata=header)
    partial.replace(path)


def load_encoder(path: Path) -> StateEncoder:
    """An encoder with the weights of a file, ready for inference.

    Raises:
        WeightsError: the file is missing, damaged, or was not made by :func:`save_encoder`.
    """
    if not path.is_file():
        raise WeightsError(f"weights file {path} does not exist; {_RETRAIN}", path)
    try:
        with safe_open(path, framework="pt") as file:
            header = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError, ValueError) as error:
        raise WeightsError(
            f"weights file {path} is damaged or not a safetensors file ({error}); {_RETRAIN}", path
        ) from error
    if header.get("format") != FORMAT:
        raise WeightsError(f"weights file {path} holds no state encoder; {_RETRAIN}", path)
    try:
        encoder = StateEncoder(EncoderConfig(**json.loads(header["config"])))
        encoder.parts = _parts_of(tensors)
        encoder.load_state_dict(
            {name: value for name, value in tensors.items() if not name.startswith(_PARTS)}
        )
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise WeightsError(
            f"weights file {path} is of another version ({error}); {_RETRAIN}", path
        ) from error
    if not all(value.isfinite().all() for value in tensors.values()):
        raise WeightsError(
            f"weights file {path} holds values that are not finite; {_RETRAIN}", path
        )
    return encoder.eval()


def _tensors_of(parts: Parts | None) -> dict[str, Tensor]:
    if parts is None:
        return {}
    tensors = {f"{_PARTS}around": torch.from_numpy(parts.around)}
    for number, part in enumerate(parts.parts):
        name = f"{_PARTS}{number:03d}"
        tensors[f"{name}.bits"] = torch.from_numpy(part.bits.astype(np.int32))
        tensors[f"{name}.patterns"] = torch.from_numpy(np.packbits(part.patterns, axis=1))
        tensors[f"{name}.radius"] = torch.tensor([part.radius])
    return tensors


def _parts_of(tensors: Mapping[str, Tensor]) -> Parts | None:
    if f"{_PARTS}around" not in tensors:
        return None
    parts = []
    for name in sorted(name for name in tensors if name.endswith(".patterns")):
        start = name.removesuffix("patterns")
        bits = tensors[f"{start}bits"].numpy().astype(np.int64)
        packed = tensors[name].numpy()
        patterns = np.unpackbits(packed, axis=1, count=len(bits)).astype(np.bool_)
        parts.append(Part(bits, patterns, int(tensors[f"{start}radius"][0])))
    return Parts(tensors[f"{_PARTS}around"].numpy(), tuple(parts))
