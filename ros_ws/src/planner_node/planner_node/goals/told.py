# SPDX-License-Identifier: Apache-2.0
"""The relations that were read so far, and who was spoken of: what "it" and "both" stand for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from scene_graph import ABOVE, BESIDE, LEFT, PREDICATES, UP, Phrase

from ..errors import InvalidGoalError
from .language import DIFFERENT_PLACES, EACH_OTHER, IT, SAME_PLACE, UPON
from .objections import check_places, unclear
from .parsed import ParsedRelation, counted, in_one_place, none_but
from .said import Said, no_relation
from .terms import Kind, Term, Words, is_any_place


class Told:
    """What a goal has said so far.

    Attributes:
        relations: what was read.
        subjects, object, link: of the last relation; before a sentence's first one, of the
            sentence before.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self.relations: list[ParsedRelation] = []
        self.subjects: list[Term] = []
        self.object: Term | None = None
        self.link: tuple[Phrase, bool, Words] | None = None
        #: The subjects of a relation that was told of its object.
        self._of_object: list[Term] = []
        #: Those that were spoken of as "every box"; a number of blocks leaves open which they are.
        self._kinds: list[Term] = []
        #: All blocks that were named, by their words.
        self._named: dict[str, Term] = {}

    def all_named(self, term: Term) -> list[Term]:
        """The blocks that "both" or "all three" stands for: those that were named, if so many.

        "all" of more than were named, or of none, is every one of the scene.
        """
        number = term.exact or (2 if not term.bare else max(2, len(self._named)))
        if len(self._named) != number:
            if term.bare and (term.exact is not None or not self._named):
                return [replace(term, bare=False)]
            raise unclear(term)
        return list(self._named.values())

    def meant(
        self, term: Term, phrase: Phrase | None, carried: bool = False, again: bool = False
    ) -> Term:
        """A name itself; for "it" the one that it can only stand for.

        Args:
            again: it is the subject of a relation of the kind that was denied before.
            phrase: the relation whose object it is; None for a subject.
            carried: the relation's subject is that of the one before.
        """
        if term.words.text not in IT:
            return term
        if phrase is not None and phrase.needs_place and self.object and self.object.is_place:
            return self.object  # "two in the left stack, and red at the bottom of it"
        subject = self.subjects[0] if len(self.subjects) == 1 else None
        found: Term | None = None
        if self.object is None or self.object.is_place or (again and self.link and self.link[1]):
            found = subject  # "red not on blue, put it on green"
        elif phrase is not None and (carried or self._opposite(phrase)):
            found = self.object
        elif phrase == Phrase(PREDICATES[UP]) and self.link is not None:
            # On what already carries a block nothing else can be put.
            before, denied, _ = self.link
            found = subject if before == phrase and not denied else None
        if found is None or found.kind is not Kind.THE:
            raise unclear(term)
        return found

    def _opposite(self, phrase: Phrase) -> bool:
        """Whether it is "right of" behind "left of": "red left of blue and green right of it"."""
        before = self.link[0] if self.link is not None else phrase
        return before.predicate == phrase.predicate and before.inverse != phrase.inverse

    def clear(self, term: Term) -> None:
        """Adds that nothing stands on it."""
        nothing = Term(Words("block", term.words.offset), Kind.NO, 0, 0)
        self.relations.append(ParsedRelation(nothing, Phrase(PREDICATES[UP]), term))

    def add_links(self, subjects: Sequence[Term], clause: Said) -> None:
        """The relations of a chain, "red on blue on green"."""
        links = clause.links
        for (phrase, denied, object_, _), (other, _, _, written) in pairwise(links):
            # Where it can be read as said of the first as well, and that is something else, it is
            # asked back: "put red left of blue on stack1".
            same = phrase == other and phrase.predicate.name in (UP, ABOVE, LEFT)
            onto = phrase.predicate.name == UP and not phrase.inverse
            if denied or object_.kind is not Kind.THE or not (same or onto):
                raise InvalidGoalError(
                    "a second relation starts here; separate relations by a comma or 'and'",
                    written.offset,
                    written.text,
                )
        if len(links) > 1 and any(term.kind is Kind.COUNT and term.bare for term in subjects):
            raise unclear(subjects[0])  # "the one on red should be on blue"
        carried = clause.subject is None
        if carried and subjects and all(term.kind is Kind.NO for term in subjects):
            links = tuple((phrase, False, other, said) for phrase, _, other, said in links)
        for phrase, denied, object_, written in links:
            if object_.words.text in EACH_OTHER:
                if len(subjects) == 1 and subjects[0].exact == 2:
                    subjects = [subjects[0], subjects[0]]  # "the two red ones next to each other"
                if len(subjects) != 2 or phrase.predicate.name != BESIDE:
                    raise unclear(object_)
                subjects, objects = subjects[:1], subjects[1:]
            elif self._about_one_place(subjects, phrase, denied, object_):
                continue
            elif object_.stands_for_several:
                objects = self.all_named(object_)
            else:
                objects = [self.meant(object_, phrase, carried)]
            for one in objects:
                self.add(subjects, phrase, denied, written, one)
                if clause.adjacent:
                    self.add(subjects, Phrase(PREDICATES[BESIDE]), False, written, one)
            self.subjects, self.object = list(subjects), objects[-1]
            self.link = (phrase, denied, written)
            subjects, carried = objects[-1:], False
        if clause.of_object and not objects[-1].is_place:
            # Of whom it was said is who is spoken of.
            self._of_object = self.subjects
            self.subjects, self.object = list(objects[-1:]), None

    def add_again(self, clause: Said) -> None:
        """What was said last, of another: "and so should blue", "neither should blue"."""
        assert clause.subject is not None
        told_of = self.subjects if self.object is not None else self._of_object
        denied = self.link is not None and (
            self.link[1] or any(one.kind is Kind.NO for one in told_of)
        )
        if self.link is None or denied == (clause.again == "so"):
            raise no_relation(self._text, clause.words)
        if self.object is not None:
            self.add([clause.subject], *self.link, self.object)
        else:
            self.add(self._of_object, *self.link, clause.subject)  # "red has nothing on it"

    def add_edge(self, subjects: Sequence[Term], clause: Said) -> None:
        """The relations of "red at the bottom", "red at the top of it"."""
        first = clause.words[0]
        if len(subjects) != 1 or len(clause.links) > 1:
            raise no_relation(self._text, clause.words)
        place, denied, written = self.object, False, first
        if clause.links:
            _, denied, place, written = clause.links[0]
        if place is None or not place.is_place or place.is_every_place or denied:
            raise no_relation(self._text, clause.words)
        if clause.edge == UPON and len(self.subjects) == 1 and self.subjects[0].kind is Kind.THE:
            # "red in stack1, blue on top": of it, or of the stack?
            raise unclear(subjects[0])
        bottom = clause.edge == "bottom"
        phrase = Phrase(PREDICATES[UP if bottom else ABOVE])
        self.add(subjects, phrase, False, written, place)
        if not bottom:
            self.clear(subjects[0])
        self.subjects, self.object, self.link = list(subjects), place, (phrase, False, written)

    def add_next(self, block: Term, upwards: bool) -> None:
        """The next one of "red at the bottom, then blue, then green"."""
        if block.kind is not Kind.THE or block.is_place or len(self.subjects) != 1:
            raise unclear(block)
        phrase = Phrase(PREDICATES[UP], inverse=not upwards)
        self.add([block], phrase, False, block.words, self.subjects[0])
        self.subjects = [block]

    def _of_same_kind(self, term: Term) -> Term:
        """A number alone with the kind of what was counted before: "two boxes here, one there"."""
        before = self.subjects[0] if len(self.subjects) == 1 else None
        if term.bare and term.others:
            # "one red block here and the other there": there are no more of them than these.
            if before is not None and before.kind is Kind.THE and term.least > 1:
                rest = replace(term.words, text="block")  # "the other three"
                return replace(term, words=rest, kind=Kind.EVERY, bare=False, exact=term.least)
            if before is None or before.kind is not Kind.COUNT or before.most != before.least:
                raise unclear(term)
            exact = before.least + term.least
            return replace(term, words=before.words, others=False, bare=False, exact=exact)
        if not term.bare or before is None or before.kind is Kind.THE or before.others:
            return term
        return replace(term, words=replace(before.words, offset=term.words.offset), bare=False)

    def _about_one_place(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, object_: Term
    ) -> bool:
        """Adds the relations of "red and blue in the same stack"; False where it says no such."""
        text = object_.words.text
        blocks = list(subjects)
        others = SAME_PLACE | DIFFERENT_PLACES
        with_other = next((head for head in others if text.startswith(f"{head} as ")), None)
        if with_other is not None:
            rest = text.removeprefix(f"{with_other} as ")
            blocks.append(self.meant(Term(Words(rest, object_.words.offset)), phrase))
        elif text in SAME_PLACE | DIFFERENT_PLACES:
            if len(blocks) == 1 and self.object is not None and not self.object.is_place:
                blocks.append(self.object)  # "red under blue, in the same stack"
        else:
            return False
        same = (with_other or text) not in DIFFERENT_PLACES
        relations = in_one_place(blocks, same, denied)
        if relations is None or phrase != Phrase(PREDICATES[ABOVE], needs_place=True):
            raise unclear(object_)
        self.relations += relations
        if with_other and len(blocks) == 2:
            self.subjects, self.object = blocks[:1], blocks[1]
        self._named |= {term.words.text: term for term in blocks}
        return True

    def add(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, written: Words, object_: Term
    ) -> None:
        """Adds that every subject has a relation to an object.

        Raises:
            InvalidGoalError: it is not clear who is meant, or it cannot be said of a place.
        """
        counting = counted(subjects)
        if counting is None or object_.listed:
            raise unclear(object_ if object_.listed else subjects[0])
        subjects = [self._of_same_kind(term) for term in counting]
        if len(subjects) > 1 and subjects[-1].kind is Kind.NO and subjects[-1].others:
            # "red and nothing else in stack1"
            subjects = [replace(subject, only=True) for subject in subjects[:-1]]
        bounded = all(term.kind is Kind.COUNT and not term.least for term in subjects)
        if is_any_place(object_) and (bounded or all(term.kind is Kind.NO for term in subjects)):
            object_ = replace(object_, kind=Kind.EVERY)  # "at most two blocks in any stack"
        if only := [subject for subject in subjects if subject.only]:
            nothing_else = none_but(subjects, phrase, denied, object_)
            if nothing_else is None:
                raise unclear(only[0])
            self.relations.append(nothing_else)
        self._named |= {words.text: Term(words) for term in subjects for words in term.among}
        for subject in subjects:
            if subject.others:
                spoken = [*self._named.values(), *self._kinds]
                if not spoken or any(term.kind is Kind.COUNT for term in spoken):
                    raise unclear(subject)
                if subject.kind is Kind.NO and set(self._named) != {
                    term.words.text for term in self.subjects
                }:
                    # Who else was named may be meant as well.
                    raise unclear(subject)
                subject = replace(subject, others=False, but=tuple(spoken))
            if subject.kind in (Kind.EVERY, Kind.COUNT) and not subject.others:
                self._kinds.append(subject)
            for term in (subject, object_):
                if term.words.text in IT:
                    raise unclear(term)
                if term.kind is Kind.THE and not term.is_place:
                    self._named.setdefault(term.words.text, term)
            check_places(subject, phrase, object_, written.text)
            meaning = phrase
            together = subject.several or len(subjects) > 1
            if together and object_.is_place and phrase == Phrase(PREDICATES[UP]) and not denied:
                # Several blocks on a place cannot all stand directly on it.
                meaning = phrase._replace(predicate=PREDICATES[ABOVE])
            self.relations.append(ParsedRelation(subject, meaning, object_, denied))
