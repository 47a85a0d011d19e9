# SPDX-License-Identifier: Apache-2.0
"""The words of goals: what may be left out, what stands for what, and what looks like a typo.

Only words that are known are left out: a word that nobody knows ends up in the name of a block, and
the goal is asked back. That is what keeps a sentence from being read wrong.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection
from typing import Final

#: Verbs that are nouns too, where a number or a phrase follows: "stack 2 below red".
NOUN_VERBS: Final = frozenset({"place", "stack", "position", "pile"})
#: Ask for the relation that follows.
VERBS: Final = NOUN_VERBS | {
    "put", "move", "set", "get", "bring", "lay", "drop", "leave", "keep", "shift", "push",
    "slide", "transfer", "arrange", "build", "balance", "sit", "make", "let", "have",
    "relocate", "stick", "add", "pop", "plop", "plonk", "chuck", "dump", "shove", "hoist",
    "distribute", "rearrange", "spread", "organize", "organise", "reorganize", "create", "form",
    "construct", "assemble", "give", "show", "remove", "load", "deposit", "carry", "placing",
    "putting", "moving", "stacking",
}  # fmt: skip
#: Pick something up that the next clause calls "it".
TAKES: Final = frozenset(
    {"take", "grab", "lift", "pick", "fetch", "grasp", "get", "use", "find", "locate"}
)
#: Say of a block or place that nothing stands on it.
CLEAR: Final = frozenset({"clear", "empty", "free", "bare", "vacant", "unoccupied", "uncovered"})
#: Mean nothing for the goal wherever they stand.
MUTE: Final = VERBS | {
    "is", "are", "be", "being", "stays", "stay", "sits", "sitting", "stands", "stand",
    "standing", "rests", "resting", "goes", "go", "going", "lies", "lie", "lying", "placed",
    "moved", "stacked", "located", "positioned", "should", "shall", "must", "has", "needs",
    "need", "ought", "would", "will", "wants", "want", "come", "comes", "belongs", "belong",
    "ends", "gets", "please", "kindly", "i", "we", "you", "me", "us", "like", "love", "prefer",
    "now", "first", "finally", "also", "just", "simply", "so", "that", "there", "hey", "hi",
    "hello", "robot", "ok", "okay", "thanks", "thx", "sure", "ensure", "were", "still", "again",
    "too", "nice", "great", "your", "task", "goal", "next", "could", "wish", "maybe", "perhaps",
    "somewhere", "sir", "dear", "afterwards", "after", "quickly", "carefully", "gently", "do",
    "does", "did", "try", "may", "might", "well", "as", "down", "anywhere", "today", "pls",
    "plz", "pleas", "was", "secondly", "thirdly", "lastly", "together", "instead", "itself",
    "themselves", "ask", "trouble", "think", "guess", "suppose", "see", "check", "confirm",
    "verify", "am", "er", "erm", "um", "uh", "uhm", "really", "certain", "kind", "enough",
    "asap", "quick", "pray", "rest", "suggest", "request", "strictly", "basically", "literally",
    "definitely", "absolutely", "always", "completely", "totally", "ideally", "actual",
    "needing", "slowly", "careful", "been", "found", "end", "kept", "stood", "sat", "put",
    "seen", "cheers", "appreciate", "good", "grateful", "possible", "my", "our", "bitte", "job",
    "plan",
    "aim", "mission", "objective", "delighted", "happy", "glad", "pleased", "gimme", "yo",
    "bro", "dude", "better",
}  # fmt: skip
#: Join relations as a comma does.
JOINS: Final = frozenset(
    {"and", "adn", "then", "but", "while", "plus", "&", "though", "although", "yet"}
)
#: Begin a relation after words that name nothing: "build a tower with red on blue".
OPENINGS: Final = frozenset({"with", "where", "whereby"})
#: Polite on its own: a part of a goal of nothing else says nothing.
POLITE: Final = frozenset({
    "please", "kindly", "hey", "hi", "hello", "robot", "ok", "okay", "thanks", "thx", "dear",
    "sir", "now", "sure", "so", "well", "pleas", "plz", "pls", "hmm", "hm", "um", "uh", "oh",
    "ah", "uhm", "er", "erm", "alright", "right", "good", "morning", "afternoon", "evening",
    "day", "cheers", "greetings", "yours", "sincerely", "faithfully", "regards", "best", "bye",
    "goodbye", "obliged", "appreciated", "welcome", "madam", "friend", "buddy", "mate", "ta",
    "ever", "thank", "again", "there", "asap", "quick", "quickly", "carefully", "gently",
    "slowly", "careful", "everyone", "pray", "love", "sweetheart", "darling", "honey",
    "monsieur", "mister", "miss", "boss", "pal", "dude", "guys", "folks", "professor", "doctor",
    "pardon", "excuse", "many", "yes", "yeah", "yep", "very", "much", "advance", "time",
    "listen", "look", "remember", "honestly", "frankly", "basically", "next", "finally",
    "lastly", "first", "ultimately", "firstly", "secondly", "thirdly", "then", "anyway",
    "anyways", "essentially", "note", "attention", "umm", "hmmm", "eh", "ha", "haha", "lol",
    "wow", "yay", "today", "tonight", "tomorrow", "man", "bro", "team", "this", "computer",
    "machine", "nurse", "colleague", "gosh", "afterwards", "additionally", "furthermore",
    "moreover", "also", "obviously", "clearly", "ideally", "importantly", "important", "bitte",
    "danke", "merci", "servus", "hallo", "moin", "sweetie", "young", "old", "lady", "ladies",
    "gentlemen", "children", "kids", "kiddo", "hon", "all-right", "mkay", "okey", "k", "kk",
    "oki", "ty", "tx",
})  # fmt: skip
#: Words of a heading, as in "the goal for my class: red on blue"; all else before a colon counts.
HEADING: Final = frozenset({
    "pile", "row", "line", "students", "student", "kids", "goal", "task", "tower",
    "arrangement", "setup", "configuration", "order", "plan", "target", "final", "my", "our",
    "for", "class", "demo", "experiment", "lesson", "a", "this", "one", "new", "layout",
    "exercise", "of", "state", "sort", "like", "follows", "following", "them", "required",
    "desired", "wanted", "end", "result", "towers", "piles", "two", "step", "part", "condition",
    "trial", "phase", "number", "nice", "high", "big", "tall", "little", "small", "satisfy",
    "be", "request", "instructions", "instruction",
})  # fmt: skip
#: Begin what says of all of a kind; "but" behind them leaves some out.
EVERYONE: Final = frozenset({
    "every", "each", "all", "everything", "any", "anything", "no", "nothing", "none", "both",
})  # fmt: skip
#: Every block that was not named before.
OTHERS: Final = frozenset({"everything else", "all others", "others", "rest", "other ones"})
#: No block that was not named before.
NOTHING_ELSE: Final = frozenset({
    "nothing else", "no other", "no others", "no other block", "no other blocks", "none other",
})  # fmt: skip
#: Says what should have been.
BYGONE: Final = "bygone"
EXCEPT: Final = "except"
#: In front of what is not meant: "on blue instead of green".
INSTEAD: Final = "instead-of"
#: Between what was said and what is meant instead.
CORRECTION: Final = "correction"
#: Takes back what was said last; what follows is new.
TAKEN_BACK: Final = "taken-back"
#: The two or three blocks that were named before.
BOTH: Final = frozenset({"both", "they", "them", "these", "either-of-them"})
#: The block that was named before.
IT: Final = frozenset({"it", "this", "that", "him", "her"})
#: Where a block is said to be: "red on top".
UPON: Final = "upon"
EACH_OTHER: Final = frozenset({"each-other"})
_PLACES: Final = ("stack", "tower", "place", "pile", "column")
#: "in the same stack", "in different stacks"; a plural comes without its s.
SAME_PLACE: Final = frozenset(f"same {place}" for place in _PLACES)
DIFFERENT_PLACES: Final = frozenset(
    f"{word} {place}" for word in ("different", "separate", "distinct") for place in _PLACES
)
#: Behind a name and before a relation, looked for there with typos too.
MODALS: Final = frozenset({
    "should", "shall", "must", "would", "stands", "standing", "sitting", "placed", "needs",
    "goes",
})  # fmt: skip
ARTICLES: Final = frozenset({"the", "teh", "hte", "th", "da", "der", "die", "das"})
NEGATION: Final = "not"
#: Words that hold a negation; with what is left of them.
SHORT_NEGATIONS: Final = {
    "dont": "do", "isnt": "is", "shouldnt": "should", "never": "do", "cannot": "could",
    "mustnt": "must", "without": "do", "arent": "is", "wont": "will", "wouldnt": "would",
    "cant": "could", "dnt": "do", "doesnt": "does",
}  # fmt: skip
#: Number the steps, in front of a verb: "second, put red on blue"; elsewhere they name something.
STEPS: Final = frozenset({"second", "third", "fourth", "fifth", "last"})
#: Say of a place how many blocks are in it, of a block what is on it.
HOLDS: Final = frozenset({"have", "has", "contain", "contains", "hold", "holds"})

#: Say of a block what is on it.
CARRIES: Final = frozenset({"carry", "carries", "bear", "bears", "support", "hold", "holds"})

#: Fit every object.
NOUNS: Final = frozenset({
    "block", "object", "one", "thing", "piece", "item", "brick", "part", "element",
    "thingy", "klotz", "stone", "toy", "guy",
})  # fmt: skip
#: Of several, what they are called one by one.
PLURALS: Final = {
    "blocks": "block", "objects": "object", "ones": "one", "things": "thing", "pieces": "piece",
    "items": "item", "bricks": "brick", "parts": "part", "elements": "element",
    "thingies": "thingy",
    "stones": "stone", "toys": "toy", "guys": "guy",
    "boxes": "box", "cubes": "cube", "cylinders": "cylinder",
    "spheres": "sphere", "balls": "ball", "prisms": "prism", "roofs": "roof", "cuboids": "cuboid",
    "stacks": "stack", "places": "place", "towers": "tower", "columns": "column", "piles": "pile",
    "positions": "position", "spots": "spot", "slots": "slot",
}  # fmt: skip
#: Other words for a shape or a colour, where no object is called so.
SYNONYMS: Final = {
    "cube": "box", "cuboid": "box", "bx": "box", "boks": "box", "ball": "sphere", "roof": "prism",
    "wedge": "prism", "tube": "cylinder",
    "pipe": "cylinder", "barrel": "cylinder", "drum": "cylinder", "orb": "sphere",
    "gray": "grey", "violet": "purple",
}  # fmt: skip
NUMBERS: Final = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7,
    "eight": 8, "nine": 9, "ten": 10,
}  # fmt: skip
#: Colours beside those of :data:`scene_graph.COLORS`.
MORE_COLORS: Final = frozenset({
    "white", "gold", "golden", "silver", "tan", "teal", "lime", "navy", "beige", "maroon",
    "olive", "turquoise", "indigo", "amber", "coral", "crimson", "scarlet", "rose", "ruby",
    "plum", "lilac", "aqua", "azure", "bronze", "copper", "cream", "peach", "salmon",
})  # fmt: skip
#: Words that are right as they are, so that they are not taken for others with a typo.
OTHER_WORDS: Final = MORE_COLORS | {
    "light", "dark", "pale", "bright", "deep", "tin", "bed", "glue", "line", "back", "ink",
    "pine", "bin", "can", "them", "they", "their", "there", "here", "these", "those", "which",
    "than", "only", "same", "different", "alone", "together", "either", "neither", "off",
    "nothing", "none", "everything", "something", "anything", "order", "him", "her", "his",
    "its", "base", "peak", "single", "half", "mean", "lowest", "highest", "topmost",
    "uppermost", "bottommost", "meant", "wait", "once", "when", "unless", "until", "whenever",
    "before", "after", "during",
}  # fmt: skip
#: "the left stack", "the middle place"; with what they are called.
SIDES: Final = {
    "left": "left", "leftmost": "left", "middle": "middle", "center": "middle", "centre": "middle",
    "central": "middle", "right": "right", "rightmost": "right", "left-hand": "left",
    "right-hand": "right", "lefthand": "left", "righthand": "right", "left-most": "left",
    "right-most": "right",
}  # fmt: skip
PLACE_NOUNS: Final = frozenset({
    "stack", "place", "position", "spot", "slot", "column", "pile", "tower",
})  # fmt: skip

#: How alike a typo has to be to what was meant, as difflib measures it: two letters exchanged in
#: four, one missing in four.
LIKENESS: Final = 0.75


def meant(word: str, known: Collection[str], right: Collection[str] = ()) -> str | None:
    """The one known word that ``word`` is with a typo; None: there is none, or several are as near.

    Args:
        right: words that are no typos.
    """
    if word in known or word in right or len(word) < 3 or not word.isalpha():
        return word if word in known else None
    swaps = {word[:at] + word[at + 1] + word[at] + word[at + 2 :] for at in range(len(word) - 1)}
    if exchanged := swaps & set(known):
        return exchanged.pop() if len(exchanged) == 1 else None
    near = difflib.get_close_matches(word, sorted(known), n=2, cutoff=LIKENESS)
    if len(near) == 2:
        first, second = (difflib.SequenceMatcher(None, item, word).ratio() for item in near)
        if first - second < 0.05:
            return None
    return near[0] if near else None
