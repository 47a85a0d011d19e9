# SPDX-License-Identifier: Apache-2.0
"""What a relation says of its subjects: "on blue", "at the top", "alone", "where red is"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scene_graph import ABOVE, BESIDE, LEFT, PREDICATES, Phrase

from ..objections import unclear
from ..parsed import ParsedRelation, in_one_place, none_but
from ..terms import Described, Kind, Term, Words
from .anaphora import Anaphora
from .claims import key_of, unclear_words
from .meaning import Link, Relate
from .nominal import INSIDE, UPON

_BESIDE = Phrase(PREDICATES[BESIDE])


def _bounded(term: Term) -> bool:
    """Whether it is "at most two blocks"."""
    return term.kind is Kind.COUNT and not term.least and not term.bare


class Linking(Anaphora):
    """Says relations of their subjects."""

    def _link(
        self, subjects: list[Term], link: Link, denied: bool, item: Relate, carried: bool
    ) -> None:
        how = link.how if link.how != "or" else ""
        written = link.words
        if how == "clear":
            self._clear(subjects, denied)
            return
        if how == "side" and not carried and self._aside(subjects, link, denied):
            return
        if how == "side":
            if any(self._is_it(term) for term in (item.subject.terms if item.subject else ())):
                raise unclear_words(written)
            middle = link.names is not None and link.names.terms[0].words.side == "middle"
            if middle and not all(term.several or term.kind is Kind.NO for term in subjects):
                raise unclear_words(written)  # of a tower, or of the places?
            self._sides = True
        if how in ("top", "bottom"):
            self._edge(subjects, link, denied)
            return
        if how == "alone":
            self._alone(subjects, item, denied, link)
            return
        if how in ("same", "different"):
            others = self._who(link.names) if link.names else []
            first = subjects[0]
            if how == "same" and not (others or subjects[1:] or denied) and _bounded(first):
                every = Term(replace(written, text="stack"), Kind.EVERY)
                self._add([first], INSIDE, False, written, every)
                self.subjects, self.object = [first], None
                return
            blocks = [*subjects, *others]
            if not others and len(blocks) == 1 and blocks[0].kind is Kind.THE and self.object:
                blocks.append(self.object)  # "red under blue, in the same stack"
            pairs = [[*subjects, other] for other in others] if denied and others else [blocks]
            found = []
            for pair in pairs:
                relations = in_one_place(pair, how == "same", denied)
                if relations is None:
                    raise unclear_words(written)
                found += relations
            self.relations += found
            self._name(*blocks)
            self.subjects, self.object = blocks[:1], others[-1] if others else None
            self.link = None
            self._pair = blocks if how == "same" and not denied and len(blocks) == 2 else []
            return
        if how == "compared":
            objects = [one for one in self._pair if key_of(one) != key_of(subjects[0])]
            if denied or len(subjects) > 1 or len(objects) != 1 or link.phrase is None:
                raise unclear_words(written)
            self._add(subjects, link.phrase, False, written, objects[0])
            self.subjects, self.object = subjects, None
            return
        if how == "each other":
            if len(subjects) == 1 and subjects[0].exact == 2:
                subjects = [subjects[0], subjects[0]]
            if len(subjects) != 2:
                raise unclear(subjects[0])
            self._add(subjects[:1], _BESIDE, denied, written, subjects[1])
            self._name(*subjects)
            self._neighbors = [] if denied else list(subjects)
            self.subjects, self.object = subjects, None
            return
        if how == "not upon each other":
            if denied or len(subjects) != 2 or any(t.kind is not Kind.THE for t in subjects):
                raise unclear_words(written)
            for one, other in (subjects, subjects[::-1]):
                self._add([one], UPON, True, written, other)
            self.subjects, self.object = subjects, None
            return
        if how == "there":
            if self.object is None or not self.object.is_place:
                raise unclear_words(written)
            phrase = INSIDE
            if any(term == self.object for term in subjects):
                raise unclear_words(written)
            objects = [self.object]
        elif how == "where":
            assert link.names is not None
            (other,) = link.names.terms
            below = Term(other.words, described=Described("below", others=(other,)))
            phrase, objects = UPON, [below]
        elif how == "elsewhere":
            if denied or len(subjects) != 1 or subjects[0].kind is not Kind.THE:
                raise unclear_words(written)
            if self.object is not None and self.object.is_place and self.subjects != subjects:
                objects = [self.object]  # "red in stack1, blue elsewhere"
            else:
                own = Described("with", place=True, others=(subjects[0],))
                objects = [Term(written, described=own)]
            phrase, denied = INSIDE, True
        else:
            if link.phrase is None or link.names is None:
                raise unclear_words(written)
            phrase = link.phrase
            objects = self._objects(link, denied, subjects, carried)
        for one in objects:
            if one.described and one.described.how == "other" and not one.described.others:
                one = replace(one, described=replace(one.described, others=tuple(subjects)))
            self._add(subjects, phrase, denied, written, one)
            if link.adjacent:
                if denied:
                    raise unclear_words(written)
                self._add(subjects, _BESIDE, False, written, one)
        if phrase == _BESIDE and not denied and len(subjects) == len(objects) == 1:
            self._neighbors = [*subjects, *objects]
        if len(subjects) == 2 and phrase == INSIDE and not denied:
            self._pair = subjects
        if self._footed is not None and objects[-1].is_place and not denied:
            self._add([self._footed], UPON, False, written, objects[-1])
            self._footed = None
        self.subjects, self.object = list(subjects), objects[-1]
        self.link = (phrase, denied, written)

    def _aside(self, subjects: Sequence[Term], link: Link, denied: bool) -> bool:
        """ "red and blue in neighbouring stacks, red on the left": left of blue."""
        others = [one for one in self._neighbors if key_of(one) not in map(key_of, subjects)]
        side = link.names.terms[0].words.side if link.names else None
        if denied or len(subjects) != 1 or len(others) != 1 or side not in ("left", "right"):
            return False
        phrase = Phrase(PREDICATES[LEFT], inverse=side == "right")
        self._add(subjects, phrase, False, link.words, others[0])
        self.subjects, self.object = list(subjects), None
        return True

    def _objects(
        self, link: Link, denied: bool, subjects: Sequence[Term], carried: bool
    ) -> list[Term]:
        assert link.names is not None and link.phrase is not None
        names = link.names
        all_none = all(term.kind is Kind.NO for term in subjects)
        places = all(term.kind is Kind.THE and term.is_place for term in names.terms)
        if names.either and places and link.phrase == INSIDE and not (denied or all_none):
            among = tuple(term.words for term in names.terms)
            return [replace(names.terms[0], kind=Kind.COUNT, among=among)]
        if names.denied or (names.either and not (denied or all_none)):
            raise unclear(names.terms[0])
        if any(term.kind is Kind.NO for term in names.terms):
            raise unclear(names.terms[0])
        objects = self._who(names, link.phrase, carried)
        if denied and len(objects) > 1 and not names.either and not link.denied:
            raise unclear(objects[1])  # not left of red and blue: of neither, or not of both?
        positive = not (denied or all_none)
        if positive and len(objects) > 1 and link.phrase == UPON:
            raise unclear(objects[1])  # nothing stands directly on two
        if positive and len(objects) > 1 and all(term.is_place for term in objects):
            some = all(term.kind is Kind.COUNT for term in subjects)
            if not some:
                raise unclear(objects[1])
        return objects

    def _edge(self, subjects: Sequence[Term], link: Link, denied: bool) -> None:
        place = self.object
        if link.names is not None:
            (place,) = self._who(link.names, INSIDE)
        elif self._mentioned is place:
            self._mentioned = None
        if place is None or not place.is_place or place.is_every_place or denied:
            raise unclear_words(link.words)
        if len(subjects) != 1 or subjects[0].kind is not Kind.THE or subjects[0].is_place:
            raise unclear_words(link.words)
        upon = link.words.text.startswith(("on", "up", "right on"))
        spoken = self.subjects[0] if len(self.subjects) == 1 else None
        other = spoken is not None and spoken.words.text != subjects[0].words.text
        if link.names is None and upon and other and spoken and spoken.kind is Kind.THE:
            raise unclear(subjects[0])  # "red in stack1, blue on top": of it, or of the stack?
        bottom = link.how == "bottom"
        phrase = UPON if bottom else INSIDE
        self._add(subjects, phrase, False, link.words, place)
        if not bottom:
            self._nothing_on(subjects[0])
        self.subjects, self.object = list(subjects), place
        self.link = (phrase, False, link.words)

    def _alone(self, subjects: Sequence[Term], item: Relate, denied: bool, link: Link) -> None:
        places = [
            term
            for other in item.links
            if other.names is not None and other.phrase is not None
            for term in other.names.terms
            if term.is_place
        ]
        if denied or any(term.kind is not Kind.THE or term.is_place for term in subjects):
            raise unclear_words(link.words)
        if places:
            found = none_but(subjects, INSIDE, False, places[0])
            assert found is not None
            self.relations.append(found)
            return
        if len(subjects) > 1:
            raise unclear_words(link.words)
        others = Term(Words("block", subjects[0].words.offset), Kind.EVERY, but=tuple(subjects))
        above = Phrase(PREDICATES[ABOVE])
        self.relations.append(ParsedRelation(others, above, subjects[0], negated=True))
        self.relations.append(ParsedRelation(subjects[0], above, others, negated=True))
        self._name(*subjects)
        self.subjects, self.object = list(subjects), None

    def _clear(self, terms: Sequence[Term], denied: bool) -> None:
        for term in terms:
            if term.kind is Kind.NO:
                term, denied = replace(term, kind=Kind.EVERY), not denied
            if term.kind not in (Kind.THE, Kind.EVERY):
                raise unclear(term)
            if denied:
                some = Term(Words("block", term.words.offset), Kind.COUNT)
                place = term.is_place or term.words.text == "stack"
                phrase = INSIDE if place else UPON
                self.relations.append(ParsedRelation(some, phrase, term))
            else:
                self._nothing_on(term)
            self._name(term)
        self.subjects, self.object = list(terms), terms[-1] if terms[-1].is_place else None
