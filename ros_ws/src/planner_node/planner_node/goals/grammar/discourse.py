# SPDX-License-Identifier: Apache-2.0
"""From what sentences say one behind the other to relations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

from scene_graph import ABOVE, BESIDE, LEFT, PREDICATES, UP, Phrase

from ...errors import InvalidGoalError
from ..objections import unclear, untold
from ..parsed import Changed, ParsedRelation, Said
from ..terms import Kind, Term, Words
from .claims import unclear_words
from .linking import Linking
from .meaning import Again, Change, Item, Link, Mention, Relate, Row, Take
from .nominal import UPON


class Discourse(Linking):
    """Reads one item behind the other."""

    def read(self, joined: Iterable[tuple[str, Item]]) -> tuple[Said, ...]:
        """The relations of all items.

        Raises:
            InvalidGoalError: it is not clear who is meant, or it cannot be said of them.
        """
        fronted = False
        row = again = False
        for how, item in joined:
            if how in ("but", "."):
                self._denied = False
            if how == ".":
                self._before = len(self.relations)
            mentioned = self._mentioned
            if mentioned is not None and how == "with":
                raise unclear(mentioned)
            if row and isinstance(item, Relate) and item.subject is None and how != ".":
                raise unclear_words(item.links[0].words)
            if again and how == "but" and isinstance(item, Relate) and item.subject is None:
                raise unclear_words(item.links[0].words)  # "the same for red, but on green"
            row, again = isinstance(item, Row), isinstance(item, Again)
            if isinstance(item, Relate):
                if (
                    fronted
                    and item.bare
                    and not any(
                        term.is_place
                        for link in item.links
                        if link.names
                        for term in link.names.terms
                    )
                ):
                    raise unclear_words(item.links[0].words)  # is it in that place as well?
                fronted = item.fronted
                self._relate(item)
            elif isinstance(item, Mention):
                self._mention(item)
            elif isinstance(item, Row):
                self._row(item)
            elif isinstance(item, Take):
                self._take(item)
            elif isinstance(item, Again):
                self._again(item)
            else:
                self._change(item)
            if mentioned is not None and self._mentioned is mentioned:
                raise untold(mentioned)
        self._put_down()
        if self._mentioned is not None:
            raise untold(self._mentioned)
        self._check_now()
        if self._sides:
            for said in self.relations:
                if isinstance(said, ParsedRelation) and said.phrase.predicate.name in (
                    LEFT,
                    BESIDE,
                ):
                    raise unclear(said.subject)  # on the left of all, or of something?
        return tuple(dict.fromkeys(self.relations))

    def _check_now(self) -> None:
        """What is told by how the blocks stand now is not told of what becomes of them before."""
        for number, said in enumerate(self.relations):
            if isinstance(said, Changed):
                if said.kind not in ("keep", "same") and len(self.relations) > 1:
                    raise unclear_words(said.words)
                continue
            for term in (said.subject, said.object):
                now = term.described
                if now is not None and now.how not in ("below", "other") and number:
                    before = self.relations[0]
                    if not isinstance(before, ParsedRelation) or term not in (
                        before.subject,
                        before.object,
                    ):
                        raise unclear_words(term.words)

    def _relate(self, item: Relate) -> None:
        if item.bare and self._denied and item.subject is not None:
            raise unclear(item.subject.terms[0])  # is it denied as well?
        subjects = self._subjects(item)
        carried = item.subject is None
        denied = item.denied
        if item.subject is not None and item.subject.denied:
            denied = not denied
        links = _scoped(item.links, denied, all(term.kind is Kind.NO for term in subjects))
        if item.subject is not None and len(subjects) > 1:
            either, both = item.subject.either, item.subject.both
            if either and not denied and _of_one(subjects, links):
                # Only one can stand directly on a block: there is no "or both".
                among = tuple(term.words for term in subjects)
                subjects, either = [replace(subjects[0], kind=Kind.COUNT, among=among)], False
            if (either and not denied) or (both and denied):
                raise unclear(subjects[0])  # "not both": none, or one of them?
        self._check_chain(subjects, links)
        for link in links:
            if link.chained:
                subjects = [self.object] if self.object else subjects
            self._link(subjects, link, denied != link.denied, item, carried)
            carried = not link.chained
        if item.about and self.object is not None and not self.object.is_place:
            self.subjects, self.object = [self.object], None
        self._denied = item.denied and not item.about

    def _check_chain(self, subjects: Sequence[Term], links: Sequence[Link]) -> None:
        for link, other in pairwise(links):
            if not other.chained:
                continue
            same = link.phrase == other.phrase and link.phrase is not None
            onto = link.phrase == UPON
            names = link.names
            if (
                names is None
                or link.denied
                or len(names.terms) > 1
                or names.terms[0].kind is not Kind.THE
                or link.phrase is None
                or not (onto or (same and link.phrase.predicate.name in (UP, ABOVE, LEFT)))
                or (onto and other.denied)
            ):
                raise unclear_words(other.words)
            if any(term.kind is Kind.COUNT and term.bare for term in subjects):
                raise unclear(subjects[0])

    def _subjects(self, item: Relate) -> list[Term]:
        """Who it is said of."""
        if item.subject is None:
            if self._taken:
                return self._put()
            if not self.subjects:
                words = item.links[0].words
                raise InvalidGoalError("there is no block before this", words.offset, words.text)
            return list(self.subjects)
        terms = item.subject.terms
        if self._taken and len(terms) == 1:
            if self._is_it(terms[0]) and len(self._taken) == 1:
                return self._put()
            if terms[0].words.text == "they" and len(self._taken) > 1:
                return self._put()
        if self._taken:
            self._put_down()
        return self._who(item.subject)

    def _mention(self, item: Mention) -> None:
        self._put_down()
        if self._mentioned is not None:
            raise unclear(self._mentioned)
        if not item.told:
            self._mentioned = item.term
        self.subjects, self.object, self.link = [item.term], None, None
        if item.term.is_place:
            self.subjects, self.object = [], item.term
        self._denied = False

    def _row(self, item: Row) -> None:
        self._put_down()
        phrase = Phrase(PREDICATES[item.predicate], inverse=False)
        blocks = [self._meant(term, None) for term in item.names]
        written = Words(phrase.predicate.words, blocks[0].words.offset)
        if item.place is not None:
            self._add(blocks[:1], UPON, False, written, item.place)
        for below, above in pairwise(blocks):
            if item.predicate == LEFT:
                self._add([below], phrase, False, written, above)
            else:
                self._add([above], phrase, False, written, below)
        self.subjects, self.object, self._denied = blocks[-1:], None, False
        self._foot = blocks[0] if item.footed and item.place is None else None
        if item.place is not None:
            self.object = item.place

    def _take(self, item: Take) -> None:
        if self._off is not None:
            self._put_down()
        self._taken += self._who(item.names)
        self._off = item.off
        self._denied = False
        if item.off is not None:
            self.subjects, self.object = list(self._taken), None

    def _put(self) -> list[Term]:
        taken, self._taken, self._off = self._taken, [], None
        return taken

    def _put_down(self) -> None:
        """What was taken and not put somewhere else is only taken away."""
        if not self._taken:
            return
        off, taken = self._off, self._put()
        if off is None or off.names is None or off.phrase is None:
            raise untold(taken[0])
        for one in self._who(off.names):
            self._add(taken, off.phrase, True, off.words, one)
        self.subjects, self.object = taken, None

    def _again(self, item: Again) -> None:
        if self.link is None or self.object is None or self.link[1] != item.denied:
            raise unclear(item.names.terms[0])
        names = self._who(item.names)
        phrase, denied, words = self.link
        self._add(names, phrase, denied or item.contrary, words, self.object)
        self.subjects = names

    def _change(self, item: Change) -> None:
        self._put_down()
        terms = tuple(self._who(item.names)) if item.names is not None else ()
        if item.kind == "swap" and len(terms) == 1 and terms[0].exact != 2:
            raise unclear(terms[0])
        self.relations.append(Changed(item.kind, item.words, terms, item.steps))
        self._name(*terms)
        self._denied = False


def _of_one(subjects: Sequence[Term], links: Sequence[Link]) -> bool:
    """Whether what is said of "red or blue" can be true of one of them only."""
    link = links[0]
    names = link.names.terms if link.names else ()
    return (
        len(links) == len(names) == 1
        and link.phrase == UPON
        and not (link.denied or link.how or names[0].is_place)
        and all(term.kind is Kind.THE for term in (*subjects, *names))
    )


def _scoped(links: tuple[Link, ...], denied: bool, none: bool) -> tuple[Link, ...]:
    """Links with what is denied of them all; raises InvalidGoalError where it is not clear.

    Args:
        denied: it is denied that the subject has them.
        none: that there is no such subject.
    """
    first, *others = links
    ways = {link.how == "or" for link in links[:-1]}
    if (denied and others and ways != {True}) or ((denied or none) and any(
        link.denied for link in links
    )):  # fmt: skip
        raise unclear_words(links[-1].words)  # not on blue and not on green, or not on both?
    if denied or none or True not in ways:
        return links
    if not first.denied:
        raise unclear_words(first.words)
    return tuple(replace(link, denied=True) for link in links)
