# SPDX-License-Identifier: Apache-2.0
"""Weights files of the learnt action model M2, π and D in one: safetensors."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Final

import numpy as np
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from ..errors import PlannerError
from .effect_network import Discriminator, EffectConfig, EffectNetwork

FORMAT: Final = "tamp action model M2, version 1"
#: The weights that ship with the package.
DEFAULT_ACTION_MODEL: Final = Path(__file__).parents[1] / "weights" / "action_model.safetensors"
_RETRAIN: Final = "train new ones with `make train-latent`"


class ModelWeightsError(PlannerError):
    """A weights file that is missing, damaged or not ours."""


def save_action_model(
    policy: EffectNetwork, discriminator: Discriminator, path: Path, metadata: Mapping[str, str]
) -> None:
    """Writes both networks; replaces an older file only once the new one is complete."""
    header = {**metadata, "format": FORMAT, "config": json.dumps(asdict(policy.config))}
    tensors = {f"policy.{name}": value for name, value in policy.state_dict().items()}
    tensors |= {f"discriminator.{name}": v for name, v in discriminator.state_dict().items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    save_file({name: value.contiguous() for name, value in tensors.items()}, partial, header)
    partial.replace(path)


def load_action_model(path: Path) -> tuple[EffectNetwork, Discriminator]:
    """π and D with the weights of a file, ready for inference.

    Raises:
        ModelWeightsError: the file is missing, damaged, or was not made by
            :func:`save_action_model`.
    """
    if not path.is_file():
        raise ModelWeightsError(f"weights file {path} does not exist; {_RETRAIN}")
    try:
        with safe_open(path, framework="pt") as file:
            header = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if header.get("format") != FORMAT:
            raise ModelWeightsError(f"weights file {path} holds no action model; {_RETRAIN}")
        config = EffectConfig(**json.loads(header["config"]))
        lengths = tensors["policy.sizes"].tolist()
        parts = np.split(tensors["policy.index"].numpy(), np.cumsum(lengths)[:-1])
        policy, discriminator = EffectNetwork(config, parts), Discriminator(config, parts)
        for prefix, network in (("policy.", policy), ("discriminator.", discriminator)):
            network.load_state_dict(
                {k.removeprefix(prefix): v for k, v in tensors.items() if k.startswith(prefix)}
            )
    except (SafetensorError, OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise ModelWeightsError(f"weights file {path} is damaged ({error}); {_RETRAIN}") from error
    return policy.eval(), discriminator.eval()
