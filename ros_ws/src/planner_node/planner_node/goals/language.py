# SPDX-License-Identifier: Apache-2.0
"""Words of names: for blocks of no kind, shapes, places, and numbers."""

from __future__ import annotations

from typing import Final

#: Name a block, whatever it is.
NOUNS: Final = frozenset({
    "block", "object", "one", "thing", "piece", "item", "brick", "part", "element",
    "thingy", "klotz", "stone", "toy", "guy",
})  # fmt: skip
#: Other words for a shape or a colour, where no object is called so.
SYNONYMS: Final = {
    "cube": "box", "cuboid": "box", "bx": "box", "boks": "box", "crate": "box", "ball": "sphere",
    "orb": "sphere", "bead": "sphere", "globe": "sphere", "marble": "sphere", "roof": "prism",
    "wedge": "prism", "tube": "cylinder", "pipe": "cylinder", "barrel": "cylinder",
    "drum": "cylinder", "roller": "cylinder", "gray": "grey", "violet": "purple",
}  # fmt: skip
NUMBERS: Final = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7,
    "eight": 8, "nine": 9, "ten": 10,
}  # fmt: skip
PLACE_NOUNS: Final = frozenset({
    "stack", "place", "position", "spot", "slot", "column", "pile", "tower",
})  # fmt: skip
#: "the left stack", "the middle place".
SIDES: Final = frozenset({"left", "middle", "right"})
