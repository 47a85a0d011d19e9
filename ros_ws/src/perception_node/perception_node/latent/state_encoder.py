# SPDX-License-Identifier: Apache-2.0
"""The state encoder G (4.2.1): z = G(x), a code of bits on a map of 32 x 32 places.

A code is told as a row of bytes, in which its bits lie packed: it can be compared and hashed, which
is all that a search asks of a state.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from perception_node.errors import BadImageError

from .networks import IMAGE, MAP, Decoder, Encoder
from .parts import Parts, find_parts
from .quantiser import quantiser_named

#: Images (n, 128, 128, 3), 0 to 255.
Images = NDArray[np.uint8]
#: Codes (n, b): the bits of each, packed.
Codes = NDArray[np.uint8]

#: Latent sizes o that Figure 4.9 compares.
CHANNELS: Final = (8, 16, 32, 64)
#: So often a code is decoded and encoded anew at most until it stays what it is.
MAX_ROUNDS: Final = 6
_BATCH: Final = 64


@dataclass(frozen=True)
class EncoderConfig:
    """What the networks are like.

    Attributes:
        quantiser: a name of :data:`.quantiser.QUANTISERS`.
        channels: o of the latent (o, 32, 32).
        width: channels of the networks' layers.
    """

    quantiser: str = "binary"
    channels: int = 8
    width: int = 24


class StateEncoder(nn.Module):
    """G and its inverse, as far as it has one.

    Attributes:
        config: what its networks are like.
        parts: what codes of pictures are made of; None until :meth:`learn_parts` was called.
    """

    def __init__(self, config: EncoderConfig) -> None:
        super().__init__()
        self.config = config
        self.parts: Parts | None = None
        self.quantiser = quantiser_named(config.quantiser, config.channels)
        self.encoder = Encoder(config.channels, config.width)
        self.decoder = Decoder(config.channels, config.width)
        self.to(memory_format=torch.channels_last)  # type: ignore[call-overload]

    @property
    def bits(self) -> int:
        """Of a whole code."""
        return self.quantiser.bits * MAP * MAP

    @torch.inference_mode()
    def encode(self, images: Images, snapped: bool = True) -> Codes:
        """The codes of images (n, 128, 128, 3) -> (n, bits / 8).

        Args:
            snapped: see :meth:`snap`.

        Raises:
            BadImageError: images of another size or type.
        """
        if images.dtype != np.uint8 or images.shape[1:] != (IMAGE, IMAGE, 3):
            raise BadImageError(
                f"images of shape {images.shape[1:]} and type {images.dtype} were given; the state "
                f"encoder reads ({IMAGE}, {IMAGE}, 3) of uint8"
            )
        parts = []
        for start in range(0, len(images), _BATCH):
            parts.append(pack(self._bits_of(values_of(images[start : start + _BATCH]))))
        codes = np.concatenate(parts) if parts else np.zeros((0, self.bits // 8), np.uint8)
        return self.snap(codes)[0] if snapped else codes

    def read(self, images: Images) -> tuple[Codes, NDArray[np.bool_]]:
        """The snapped codes of images, and which were near enough to valid ones to be meant.

        One that was not shows something that no picture of the training did.
        """
        return self.snap(self.encode(images, snapped=False))

    def learn_parts(self, images: NDArray[np.uint8]) -> None:
        """Finds the parts of codes in pictures (s, r, 128, 128, 3), r of each of s states."""
        codes = self.encode(images.reshape(-1, *images.shape[2:]), snapped=False)
        self.parts = find_parts(codes.reshape(*images.shape[:2], -1), MAP)

    def snap(self, codes: Codes) -> tuple[Codes, NDArray[np.bool_]]:
        """The valid codes next to codes (n, b), and which were near enough to be meant, (n,).

        By the parts where they were learnt, else by :meth:`settle`.
        """
        return self.parts.snap(codes) if self.parts else self.settle(codes)

    @torch.inference_mode()
    def decode(self, codes: Codes) -> Images:
        """The pictures that codes (n, b) stand for -> (n, 128, 128, 3)."""
        parts = [
            self._image_of(self.unpack(codes[start : start + _BATCH]))
            for start in range(0, len(codes), _BATCH)
        ]
        values = torch.cat(parts).clamp(0.0, 1.0).permute(0, 2, 3, 1) * 255.0
        return values.round().to(torch.uint8).numpy()

    @torch.inference_mode()
    def settle(self, codes: Codes) -> tuple[Codes, NDArray[np.bool_]]:
        """Decodes and encodes until a code stays what it is: the code of what it shows.

        A code that some bits of are wrong shows nearly the right picture, whose code is the right
        one; so codes of pictures of one state become the same, and predictions become valid ones.

        Returns:
            The codes, and for each whether it stays what it is: one that does not within
            :data:`MAX_ROUNDS` is no code of any picture.
        """
        settled, stable = [], []
        for start in range(0, len(codes), _BATCH):
            bits = self._settled(self.unpack(codes[start : start + _BATCH]))
            stays = self._bits_of(self._image_of(bits)) == bits
            settled.append(pack(bits))
            stable.append(stays.flatten(1).all(1).numpy())
        if not settled:
            return codes.copy(), np.zeros(0, np.bool_)
        return np.concatenate(settled), np.concatenate(stable)

    def unpack(self, codes: Codes) -> Tensor:
        """Bits 0.0 or 1.0, shape (n, bits of a place, 32, 32), of packed codes (n, b)."""
        bits = np.unpackbits(codes, axis=1, count=self.bits)
        return torch.from_numpy(bits).float().unflatten(1, (self.quantiser.bits, MAP, MAP))

    def _settled(self, bits: Tensor) -> Tensor:
        bits = bits.clone()
        moving = torch.arange(len(bits))
        for _ in range(MAX_ROUNDS):
            again = self._bits_of(self._image_of(bits[moving]))
            changed = (again != bits[moving]).flatten(1).any(1)
            bits[moving] = again
            moving = moving[changed]
            if not len(moving):
                break
        return bits

    def _bits_of(self, images: Tensor) -> Tensor:
        bits: Tensor = self.quantiser(self.encoder(images))[1]
        return bits

    def _image_of(self, bits: Tensor) -> Tensor:
        image: Tensor = self.decoder(self.quantiser.embedded(bits))
        return image


def values_of(images: Images) -> Tensor:
    """Values 0 to 1, shape (n, 3, 128, 128), of images (n, 128, 128, 3)."""
    values = torch.from_numpy(images).permute(0, 3, 1, 2).float() / 255.0
    return values.contiguous(memory_format=torch.channels_last)


def pack(bits: Tensor) -> Codes:
    """Packed codes (n, b) of bits (n, bits of a place, 32, 32)."""
    return np.packbits(bits.flatten(1).numpy().astype(np.bool_), axis=1)
