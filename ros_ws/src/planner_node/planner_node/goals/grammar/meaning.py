# SPDX-License-Identifier: Apache-2.0
"""What the parts of a sentence mean, before it is known who "it" is and how the blocks stand."""

from __future__ import annotations

from dataclasses import dataclass

from scene_graph import Phrase

from ..hashing import hashed_once
from ..terms import Term, Words


@hashed_once
@dataclass(frozen=True)
class Names:
    """Who is spoken of.

    Attributes:
        either: they are joined by "or".
        denied: it is said of none of them: "neither red nor blue".
        both: it is said that it is of all of them: "both red and blue".
    """

    terms: tuple[Term, ...]
    either: bool = False
    denied: bool = False
    both: bool = False


@hashed_once
@dataclass(frozen=True)
class Link:
    """A relation to something, without its subject.

    Attributes:
        how: what it is where it is no phrase: ``top``, ``bottom`` (of ``names``, or of what was
            spoken of), ``side`` (a phrase, but of a side), ``there``, ``alone``, ``clear``,
            ``each other``, ``not upon each other``, ``compared`` (a phrase, to the other of two
            that are in one place), ``same``, ``different`` (in one place as ``names``, or as one
            another), ``where`` (another one is now), ``elsewhere``; ``or`` of one that may hold as
            well as the next.
        adjacent: the places are neighbours too: "directly left of".
        chained: its subject is the object of the link before.
    """

    words: Words
    phrase: Phrase | None = None
    names: Names | None = None
    denied: bool = False
    how: str = ""
    adjacent: bool = False
    chained: bool = False


@hashed_once
@dataclass(frozen=True)
class Relate:
    """Some have relations.

    Attributes:
        subject: None: who was spoken of before.
        bare: it has no verb of its own, so that what was denied before may be meant to go on.
        about: the object is who is spoken of next: "red has blue on it".
        fronted: the place is told first: "in stack 0, red on blue".
    """

    subject: Names | None
    links: tuple[Link, ...]
    denied: bool = False
    bare: bool = False
    about: bool = False
    fronted: bool = False


@dataclass(frozen=True)
class Mention:
    """A block of which something is said next: "blue first, red on that".

    Attributes:
        told: something was said already that is no matter of the goal.
    """

    term: Term
    told: bool = False


@hashed_once
@dataclass(frozen=True)
class Row:
    """Names in their order: a tower from the bottom (``up``), a row from the left (``left``).

    Attributes:
        footed: it was said which is at the bottom.
    """

    predicate: str
    names: tuple[Term, ...]
    place: Term | None = None
    footed: bool = False


@dataclass(frozen=True)
class Take:
    """They are taken, from something where that is said; the next relation is of "it"."""

    names: Names
    off: Link | None = None


@dataclass(frozen=True)
class Again:
    """What was said last is said of others too.

    Attributes:
        denied: it was denied, and is of them.
        contrary: it was not, but is of them: "red is on blue, green is not".
    """

    names: Names
    denied: bool = False
    contrary: bool = False


@dataclass(frozen=True)
class Change:
    """What is told by how the blocks stand now.

    Attributes:
        kind: ``swap``, ``keep``, ``turn``, ``same``, ``shift``.
        names: of what; None: of everything.
        steps: of a shift, to the right.
    """

    kind: str
    words: Words
    names: Names | None = None
    steps: int = 0


Item = Relate | Mention | Row | Take | Again | Change
