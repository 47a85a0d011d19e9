# SPDX-License-Identifier: Apache-2.0
"""Who "it", "they", "both" and "all" are, by what was said so far."""

from __future__ import annotations

from dataclasses import replace

from scene_graph import Phrase

from ..objections import unclear
from ..terms import Kind, Term
from .claims import Claims
from .meaning import Names
from .nominal import UPON


class Anaphora(Claims):
    """Finds who is meant."""

    def _all_named(self, term: Term) -> list[Term]:
        number = term.exact or (2 if not term.bare else max(2, len(self._named)))
        if len(self._named) != number:
            if term.exact is not None and term.exact > 2 and not self._named:
                block = replace(term.words, text="block")
                return [replace(term, words=block, bare=False)]
            raise unclear(term)
        return list(self._named.values())

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
        if subject is not None and subject.kind is Kind.NO:
            found = self.object  # "nothing on red, it is to be clear"
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
