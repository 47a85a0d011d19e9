# SPDX-License-Identifier: Apache-2.0
"""From what sentences say one behind the other to relations: who "it", "both" and "there" are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

from scene_graph import ABOVE, BESIDE, LEFT, PREDICATES, UP, Phrase

from ...errors import InvalidGoalError
from ..objections import check_places, unclear, untold
from ..parsed import Changed, ParsedRelation, Said, in_one_place, none_but
from ..terms import Described, Kind, Term, Words, is_any_place
from .meaning import Again, Change, Item, Link, Mention, Names, Relate, Row, Take
from .nominal import INSIDE, UPON

_BESIDE = Phrase(PREDICATES[BESIDE])


class Discourse:
    """What was said so far.

    Attributes:
        relations: what it means.
        subjects, object, link: of the last relation.
    """

    def __init__(self) -> None:
        self.relations: list[Said] = []
        self.subjects: list[Term] = []
        self.object: Term | None = None
        self.link: tuple[Phrase, bool, Words] | None = None
        self._named: dict[str, Term] = {}
        self._kinds: list[Term] = []
        self._taken: list[Term] = []
        self._off: Link | None = None
        #: Whether the last clause was denied by its verb.
        self._denied = False
        #: A name of which nothing is said yet.
        self._mentioned: Term | None = None
        self._sides = False
        #: Who stands at the bottom of a tower of which it is not yet said where it is.
        self._foot: Term | None = None
        self._footed: Term | None = None
        #: How many relations there were before the sentence.
        self._before = 0

    def read(self, joined: Iterable[tuple[str, Item]]) -> tuple[Said, ...]:
        """The relations of all items.

        Raises:
            InvalidGoalError: it is not clear who is meant, or it cannot be said of them.
        """
        fronted = False
        row = False
        for how, item in joined:
            if how in ("but", "."):
                self._denied = False
            if how == ".":
                self._before = len(self.relations)
            mentioned = self._mentioned
            if mentioned is not None and how == "with":
                raise unclear(mentioned)
            if row and isinstance(item, Relate) and item.subject is None and how != ".":
                raise _unclear_words(item.links[0].words)
            row = isinstance(item, Row)
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
                    raise _unclear_words(item.links[0].words)  # is it in that place as well?
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
                if isinstance(said, ParsedRelation) and said.phrase.predicate.name == LEFT:
                    raise unclear(said.subject)  # on the left of all, or of something?
        return tuple(dict.fromkeys(self.relations))

    def _check_now(self) -> None:
        """What is told by how the blocks stand now is not told of what becomes of them before."""
        for number, said in enumerate(self.relations):
            if isinstance(said, Changed):
                if said.kind not in ("keep", "same") and len(self.relations) > 1:
                    raise _unclear_words(said.words)
                continue
            for term in (said.subject, said.object):
                now = term.described
                if now is not None and now.how not in ("below", "other") and number:
                    before = self.relations[0]
                    if not isinstance(before, ParsedRelation) or term not in (
                        before.subject,
                        before.object,
                    ):
                        raise _unclear_words(term.words)

    # Who is meant

    def _all_named(self, term: Term) -> list[Term]:
        number = term.exact or (2 if not term.bare else max(2, len(self._named)))
        if len(self._named) != number:
            if term.exact is not None and term.exact > 2 and not self._named:
                block = replace(term.words, text="block")
                return [replace(term, words=block, bare=False)]
            raise unclear(term)
        return list(self._named.values())

    def _is_it(self, term: Term) -> bool:
        return term.words.text == "it"

    def _meant(self, term: Term, phrase: Phrase | None, carried: bool = False) -> Term:
        """A name itself; for "it" the one that it can only stand for."""
        if not self._is_it(term):
            return term
        if self._mentioned is not None and not self._mentioned.is_place:
            mentioned, self._mentioned = self._mentioned, None
            return mentioned
        if phrase is not None and phrase.needs_place and self.object and self.object.is_place:
            return self.object
        subject = self.subjects[0] if len(self.subjects) == 1 else None
        found: Term | None = None
        if self.object is None or self.object.is_place:
            found = subject
        elif phrase is None and self.link is not None and self.link[1]:
            found = subject  # "red not on blue, put it on green"
        elif phrase is not None and (carried or self._opposite(phrase)):
            found = self.object
        elif phrase == UPON and self.link is not None:
            # On what already carries a block nothing else can be put.
            before, denied, _ = self.link
            found = subject if before == phrase and not denied else None
        if found is None or found.kind is not Kind.THE:
            raise unclear(term)
        return found

    def _opposite(self, phrase: Phrase) -> bool:
        before = self.link[0] if self.link is not None else phrase
        return before.predicate == phrase.predicate and before.inverse != phrase.inverse

    def _who(self, names: Names, phrase: Phrase | None = None, carried: bool = False) -> list[Term]:
        """All that are meant by names."""
        found: list[Term] = []
        for term in names.terms:
            if term.words.text == "they":
                found += self._all_named(term)
            elif term.bare and term.kind is Kind.EVERY and self._named:
                number = len(self._named)
                if number < 2 or 0 < self._before == len(self.relations):
                    raise unclear(term)
                found += list(self._named.values())
                if self._foot is not None and phrase is None:
                    self._footed = self._foot
            else:
                found.append(self._meant(term, phrase, carried))
        return found

    # Items

    def _relate(self, item: Relate) -> None:
        if item.bare and self._denied and item.subject is not None:
            raise unclear(item.subject.terms[0])  # is it denied as well?
        subjects = self._subjects(item)
        carried = item.subject is None
        denied = item.denied
        if item.subject is not None and item.subject.denied:
            denied = not denied
        links = _scoped(item.links, denied, all(term.kind is Kind.NO for term in subjects))
        if len(subjects) > 1 and item.subject is not None and item.subject.either and not denied:
            raise unclear(subjects[0])
        self._check_chain(subjects, links)
        for link in links:
            if link.chained:
                subjects = [self.object] if self.object else subjects
            self._link(subjects, link, denied != link.denied, item, carried)
            carried = not link.chained
        if item.about and item.links[-1].names is not None:
            names = self._who(item.links[-1].names, item.links[-1].phrase)
            if not names[-1].is_place:
                self.subjects, self.object = names[-1:], None
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
                raise _unclear_words(other.words)
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

    def _link(
        self, subjects: list[Term], link: Link, denied: bool, item: Relate, carried: bool
    ) -> None:
        how = link.how if link.how != "or" else ""
        written = link.words
        if how == "clear":
            self._clear(subjects, denied)
            return
        if how == "side":
            if any(self._is_it(term) for term in (item.subject.terms if item.subject else ())):
                raise _unclear_words(written)
            middle = link.names is not None and link.names.terms[0].words.side == "middle"
            if middle and not all(term.several or term.kind is Kind.NO for term in subjects):
                raise _unclear_words(written)  # of a tower, or of the places?
            self._sides = True
        if how in ("top", "bottom"):
            self._edge(subjects, link, denied)
            return
        if how == "alone":
            self._alone(subjects, item, denied, link)
            return
        if how in ("same", "different"):
            others = self._who(link.names) if link.names else []
            blocks = [*subjects, *others]
            if not others and len(blocks) == 1 and blocks[0].kind is Kind.THE and self.object:
                blocks.append(self.object)  # "red under blue, in the same stack"
            pairs = [[*subjects, other] for other in others] if denied and others else [blocks]
            found = []
            for pair in pairs:
                relations = in_one_place(pair, how == "same", denied)
                if relations is None:
                    raise _unclear_words(written)
                found += relations
            self.relations += found
            self._name(*blocks)
            self.subjects, self.object = blocks[:1], others[-1] if others else None
            self.link = None
            return
        if how == "each other":
            if len(subjects) == 1 and subjects[0].exact == 2:
                subjects = [subjects[0], subjects[0]]
            if len(subjects) != 2:
                raise unclear(subjects[0])
            self._add(subjects[:1], _BESIDE, denied, written, subjects[1])
            self._name(*subjects)
            self.subjects, self.object = subjects, None
            return
        if how == "there":
            if self.object is None or not self.object.is_place:
                raise _unclear_words(written)
            phrase = INSIDE
            if any(term == self.object for term in subjects):
                raise _unclear_words(written)
            objects = [self.object]
        elif how == "where":
            assert link.names is not None
            (other,) = link.names.terms
            below = Term(other.words, described=Described("below", others=(other,)))
            phrase, objects = UPON, [below]
        elif how == "elsewhere":
            if denied or len(subjects) != 1 or subjects[0].kind is not Kind.THE:
                raise _unclear_words(written)
            if self.object is not None and self.object.is_place and self.subjects != subjects:
                objects = [self.object]  # "red in stack1, blue elsewhere"
            else:
                own = Described("with", place=True, others=(subjects[0],))
                objects = [Term(written, described=own)]
            phrase, denied = INSIDE, True
        else:
            if link.phrase is None or link.names is None:
                raise _unclear_words(written)
            phrase = link.phrase
            objects = self._objects(link, denied, subjects, carried)
        for one in objects:
            if one.described and one.described.how == "other" and not one.described.others:
                one = replace(one, described=replace(one.described, others=tuple(subjects)))
            self._add(subjects, phrase, denied, written, one)
            if link.adjacent:
                if denied:
                    raise _unclear_words(written)
                self._add(subjects, _BESIDE, False, written, one)
        if self._footed is not None and objects[-1].is_place and not denied:
            self._add([self._footed], UPON, False, written, objects[-1])
            self._footed = None
        self.subjects, self.object = list(subjects), objects[-1]
        self.link = (phrase, denied, written)

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
            raise _unclear_words(link.words)
        if len(subjects) != 1 or subjects[0].kind is not Kind.THE or subjects[0].is_place:
            raise _unclear_words(link.words)
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
            raise _unclear_words(link.words)
        if places:
            found = none_but(subjects, INSIDE, False, places[0])
            assert found is not None
            self.relations.append(found)
            return
        if len(subjects) > 1:
            raise _unclear_words(link.words)
        others = Term(Words("block", subjects[0].words.offset), Kind.EVERY, but=tuple(subjects))
        above = Phrase(PREDICATES[ABOVE])
        self.relations.append(ParsedRelation(others, above, subjects[0], negated=True))
        self.relations.append(ParsedRelation(subjects[0], above, others, negated=True))
        self._name(*subjects)
        self.subjects, self.object = list(subjects), None

    def _nothing_on(self, term: Term) -> None:
        nothing = Term(Words("block", term.words.offset), Kind.NO, 0, 0)
        self.relations.append(ParsedRelation(nothing, UPON, term))

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
        self.subjects, self.object = list(terms), None

    def _mention(self, item: Mention) -> None:
        self._put_down()
        if self._mentioned is not None:
            raise unclear(self._mentioned)
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
        self._add(names, *self.link, self.object)

    def _change(self, item: Change) -> None:
        self._put_down()
        terms = tuple(self._who(item.names)) if item.names is not None else ()
        if item.kind == "swap" and len(terms) == 1 and terms[0].exact != 2:
            raise unclear(terms[0])
        self.relations.append(Changed(item.kind, item.words, terms, item.steps))
        self._name(*terms)
        self._denied = False

    # Relations

    def _name(self, *terms: Term) -> None:
        for term in terms:
            if term.kind is Kind.THE and not term.is_place and not term.described:
                self._named.setdefault(term.words.text, term)

    def _add(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, written: Words, object_: Term
    ) -> None:
        bounded = all(term.kind is Kind.COUNT and not term.least for term in subjects)
        none = all(term.kind is Kind.NO for term in subjects)
        if is_any_place(object_) and (bounded or none):
            object_ = replace(object_, kind=Kind.EVERY)  # "at most two blocks in any stack"
        if is_any_place(object_) and not (bounded or none):
            raise unclear(object_)
        if denied and any(term.kind in (Kind.NO, Kind.COUNT) for term in subjects):
            raise unclear(subjects[0])
        if denied and len(subjects) == 1 and subjects[0].kind is Kind.EVERY:
            one = subjects[0]
            if one.words.text == "block" and not one.but and not one.others and not one.only:
                none_of = replace(one, kind=Kind.NO, least=0, most=0, bare=False)
                subjects, denied = [none_of], False
        if len(subjects) > 1 and subjects[-1].kind is Kind.NO and subjects[-1].others:
            if set(self._named) - {term.words.text for term in subjects}:
                raise unclear(subjects[-1])  # is who else was named meant as well?
            subjects = [replace(subject, only=True) for subject in subjects[:-1]]
        if only := [subject for subject in subjects if subject.only]:
            self._only(subjects, phrase, denied, object_, only[0])
            subjects = [replace(subject, only=False) for subject in subjects]
        for subject in subjects:
            subject = self._among_others(subject, phrase, object_)
            if subject.kind in (Kind.EVERY, Kind.COUNT) and not subject.others:
                self._kinds.append(subject)
            for term in (subject, object_):
                if self._is_it(term):
                    raise unclear(term)
                self._name(term)
            check_places(subject, phrase, object_, written.text)
            meaning = phrase
            together = subject.several or len(subjects) > 1
            if together and object_.is_place and phrase == UPON and not denied:
                # Several blocks on a place cannot all stand directly on it.
                meaning = phrase._replace(predicate=PREDICATES[ABOVE])
            self.relations.append(ParsedRelation(subject, meaning, object_, denied))

    def _among_others(self, subject: Term, phrase: Phrase, object_: Term) -> Term:
        """ "the rest" as all but those that were named."""
        before = self.subjects[0] if len(self.subjects) == 1 else None
        counted = before is not None and before.kind is Kind.COUNT and before.most == before.least
        if subject.kind is Kind.COUNT and subject.bare:
            if before is None or before.kind is not Kind.COUNT or before.others:
                if not object_.is_place:
                    raise unclear(subject)
                return replace(subject, bare=False)  # "at most two per stack"
            return replace(subject, words=before.words, bare=False)
        if subject.kind is Kind.EVERY and subject.others and subject.exact and counted:
            assert before is not None
            # "three in stack1, the other two in stack2": there are no more of them than these.
            number = subject.exact
            return replace(
                before, least=number, most=number, exact=before.least + number, bare=False
            )
        if not subject.others:
            return subject
        if subject.kind is Kind.NO and phrase == UPON and not object_.is_place:
            on_it = [
                said.subject
                for said in self.relations
                if isinstance(said, ParsedRelation)
                and said.phrase == UPON
                and said.object.words.text == object_.words.text
                and not said.negated
            ]
            return replace(subject, others=False, but=tuple(on_it))
        spoken = [*self._named.values(), *self._kinds]
        if not spoken or any(term.kind is Kind.COUNT for term in spoken):
            raise unclear(subject)
        if subject.kind is Kind.NO and set(self._named) != {
            term.words.text for term in self.subjects
        }:
            raise unclear(subject)  # who else was named may be meant as well
        return replace(subject, others=False, but=tuple(spoken))

    def _only(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, object_: Term, one: Term
    ) -> None:
        found = none_but(subjects, phrase, denied, object_)
        if found is None:
            raise unclear(one)
        self.relations.append(found)


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
        raise _unclear_words(links[-1].words)  # not on blue and not on green, or not on both?
    if denied or none or True not in ways:
        return links
    if not first.denied:
        raise _unclear_words(first.words)
    return tuple(replace(link, denied=True) for link in links)


def _unclear_words(words: Words) -> InvalidGoalError:
    return InvalidGoalError(
        "it is not clear what this is said of; write every relation out", words.offset, words.text
    )
