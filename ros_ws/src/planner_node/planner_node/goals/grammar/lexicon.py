# SPDX-License-Identifier: Apache-2.0
"""The words that goals are made of, by what kind of word they are.

A word of several kinds is read as what fits; entries are separated by semicolons and may have
several words. What is no word of any kind is UNKNOWN, which only few rules take: nobody can say
what it means. Only FILLER is ever left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

#: Kind of word: entries; behind ``=`` what it stands for.
_WORDS: Final = """
FILLER: please; kindly; hey; hi; hello; robot; ok; okay; thanks; thx; thank you; dear; sir; um; uh;
 er; erm; uhm; umm; hmm; hm; oh; ah; well; alright; right so; so; just; simply; really; actually;
 now; then; also; too; as well; first of all; second of all; basically; honestly; frankly; again;
 quickly; carefully; gently; slowly; asap; quick; pls; plz; pleas; cheers; today; very; certainly; very much; so much; much;
 of course; for me; for us; this time; perhaps; maybe; pretty please; thank you kindly;
 many thanks; thank you very much; thanks a lot; thank you ever so much; much obliged; if you please; if you can;
 if possible; if you would; if you like; if you don't mind; if you do not mind; if you could; would you;
 will you; could you; can you; when you can; when you have time; when you get a chance; in advance;
 for a moment; for now; somewhere; simply put; like so; as follows; as well please;
 literally; definitely; absolutely; totally; finally; lastly; firstly; secondly; thirdly; afterwards; after that; next ,; next :; in that order; in this order; at last; my dear; dear sir or madam; sir or madam; to whom it may concern; yours faithfully; yours sincerely; yours truly; sincerely yours; faithfully; with best wishes; completely; greatly; immensely; enormously; most; ever so; so very; a great deal; in whichever stack you like; in whichever stack; in whatever stack; in whatever stack you like; wherever you like; wherever you want; no matter which stack; in some stack or other; whichever stack it is in; sweetheart; monsieur; strictly; neither more nor less; no more no less; no more and no less; no more nor less; and that's it; and that's all; always; at all times;
 in the end; at the end; in any case; anyway; after all; by the way; at once; immediately now;
 right now; right away; good morning; good afternoon; good evening; good day; morning; evening; bro; dude;
 mate; buddy; pal; boss; folks; guys; team; everyone; sweetie; darling; honey; love; yo; mister; madam;
 miss; professor; doctor; my friend; young man; old chap; lad; man; lol; haha; ha; hee; yay; wow; hurray;
 yes; yeah; yep; sure; excuse me; pardon me; pardon;
 with your permission; if i may; ideally; preferably; obviously; clearly; simply;
 whatsoever; at all; ever; down; back; like; anywhere; do the needful and; while you are at it; whatever you do; not necessarily directly; no need to hurry; over there; you know; you know what; let me think; let me see; let's see; let us see;
 listen; look; attention; quite; rather nicely; neatly; safely; properly; nicely; softly; cautiously; sincerely;
 bitte; danke; merci; servus; hallo; moin; ta; tx; ty; k; kk; oki; okey; mkay; yours; regards;
 kind regards; best regards; best wishes; in the middle of the table; hereby; thereby; altogether;
 necessarily; precisely please; in turn; in that order please; respectively please;
 there you go; on the double; pronto; stat; chop chop; no rush; when ready; if it is ok; if that is ok; if that's ok;
 if it is not too much trouble; if it isn't too much trouble; that is all; that is it; that's all; that's it;
 and that is it; and that is all; nothing more; thank you so much; thank you in advance; thanks in advance; bye; goodbye
AND: and; plus; as well as; along with; together with; &; and also; and then; and likewise; and furthermore; and additionally;
 while; whilst; whereas; with
BUT: but; yet; however; though; although; but also; even though
OR: or; and/or
NOR: nor
COMMA: ,; -; :
MARK: .; ?
COLON: :; -; ,; .
REALCOLON: :
NOT: not; never; under no circumstances; at no time; by no means; in no case; on no account; no longer; not ever; nowhere
THE: the; this; that; these; those; my; our; your; its; their
A: a; an; some; any; another; at least one; at least a; one or more; a single=a
EVERY: every; each; all; all of; each of; all the; each and every; any and all; every one of; every single; every last; all of the; each of the
BOTH: both; both of
NO: no; neither of; neither one of; no more; not a; not one; not a single; not any; none of; none of the; zero; no single
ALLBUT: except; except for; apart from; but; other than; besides; excluding; with the exception of; save; bar; barring; minus; but not; not counting; without
ATLEAST: at least; at lest; min; minimum; minimum of; a minimum of; no fewer than; no less than; not fewer than; not less than; as few as
ATMOST: at most; max; maximum; maximum of; a maximum of; no more than; not more than; no more then; up to; not more then; not more as; maximally; at the most
EXACTLY: exactly; precisely; just; only; a total of; in total
MORETHAN: more than; over; upwards of; more then
LESSTHAN: fewer than; less than; under; fewer then; less then
ORMORE: or more; at least; or above; at the very least
ORLESS: or less; or fewer; at most; at the most; or under; maximum; max
HALF: half of; half
NUMBER: zero=0; one=1; two=2; three=3; four=4; five=5; six=6; seven=7; eight=8; nine=9; ten=10; a couple of=2; a pair of=2
INDEX: zero=0; one=1; two=2; three=3; four=4; five=5; six=6; seven=7; eight=8; nine=9; ten=10
ORDINAL: first=1; second=2; third=3; fourth=4; fifth=5; 1st=1; 2nd=2; 3rd=3; 4th=4; 5th=5; last=-1; next to last=-2; second to last=-2
EVERYTHING: everything; all; all of it; the lot; everybody; the whole lot; all of them; them all; every single thing; all things
SOMETHING: something; anything; somebody; someone
NOTHING: nothing; none; nobody; no one; no-one; not anything; nothing at all; not a thing; nothing whatsoever; zilch; nada; neither block
ELSE: else
OTHER: other; others; remaining; rest; remainder; leftover; left over
IT: it; this; that; this one; that one; him; her; this thing; that thing; this block; that block; the same; the latter; the former one; itself
BOTHOF: both; they; them; these; those; both of them; the two; the two of them; these two; those two; the pair; the both; themselves; both blocks; the two blocks
ALLOF: all three=3; all four=4; all five=5; all three of them=3; all four of them=4; all five of them=5; all two=2; the three of them=3; the four of them=4; all of these; all of those
WHICH: which; who; that
EACHOTHER: each other; one another; eachother
NOUN: block; object; thing; piece; item; brick; part; element; thingy; klotz; stone; toy; guy; unit; specimen; component; bit; figure; shape; body; solid
ONE: one; ones
NOUNS: blocks=block; objects=object; things=thing; pieces=piece; items=item; bricks=brick; parts=part; elements=element; thingies=thingy; stones=stone; toys=toy; units=block; components=block; shapes=block; specimens=block; figures=block; solids=block
SHAPE: box; cube; cylinder; sphere; ball; prism; roof; wedge; cuboid; tube; pipe; barrel; drum; orb; roller=cylinder; bead=sphere; globe=sphere; crate=box; marble=sphere
SHAPES: boxes=box; cubes=cube; cylinders=cylinder; spheres=sphere; balls=ball; prisms=prism; cuboids=cuboid; tubes=tube; crates=box
REDS: reds=red; blues=blue; greens=green; yellows=yellow
TWIN: light; dark; pale; deep; bright; heavy; big; small; large; little; tiny; huge
COLORED: colored; coloured; color; colour; in color; in colour; of color; of colour; of the color; of the colour
PLACENOUN: stack; place; position; spot; slot; column; pile; tower; base; location; pillar; field; heap; site; area
PLACENOUNS: stacks; places; towers; columns; piles; positions; spots; slots; locations; heaps
NR: number; no; nr; num
SIDE: left; leftmost=left; middle; center=middle; centre=middle; central=middle; right; rightmost=right; left-hand=left; right-hand=right; lefthand=left; righthand=right; left-most=left; right-most=right; left hand=left; right hand=right; far left=left; far right=right; middlemost=middle; outer left=left; outer right=right; extreme left=left; extreme right=right; left most=left; right most=right; far-left=left; far-right=right
TABLE: table; floor; ground; tabletop; desk; surface; table top
BE: left standing; left sitting; left lying; is; are; be; being; been; stays; stay; stands; stand; standing; sits; sit; sitting; rests; resting; rest; lies; lie; lying; goes; go; going; comes; come; coming; belongs; belong; remains; remain; ends up; end up; ended up; ending up; winds up; wind up; perch; reside; resides; residing; live; lives; hang out; appear; appears; end; happen; finish; finishes; finish up; finishes up; land; lands; situate; wander; wanders; move; moves; hop; hops; jump; jumps; climb; climbs; 's; head; heads; travel; travels; follows; follow; at rest; wait; waits; looks best; looks good; looks nice; fits; gets; get
PLACED: placed; put; moved; stacked; located; positioned; set; found; to be found; kept; seated; sat; stood; laid; perched; transferred; brought; relocated; shifted; arranged; built; piled; rested; situated; deposited; installed; delivered; returned; carried; seen; dropped; shown
FLOAT: both; all; each; all three; all four; all five; all together; both of them; all of them
PAST: was; were; had been; used to be; has been; have been; had; got
MUST: should; shall; must; will; would; ought to; has to; have to; needs to; need to; had to; is to; are to; had better; wants to; want to; would like to; likes to; is supposed to; are supposed to; is meant to; are meant to; gotta; is required to; are required to; gets to; deserves to; loves to; would love to; to; must to; should to; better; is going to; are going to; is due to; wishes to; has got to; have got to
NEEDNOT: has to; have to; need; needs to; need to; had to; is required to; are required to; bother; have
MAY: may; might; allowed; permitted; allowed to; permitted to; supposed to; welcome to; free to; permitted; able to
CAN: can; could
DO: do; does; did
THERE: there; here
PUT: put; place; move; set; get; bring; lay; drop; leave; keep; shift; push; slide; transfer; arrange; build; balance; sit; make; let; have; relocate; stick; add; pop; plop; plonk; chuck; dump; shove; hoist; distribute; rearrange; spread; organize; organise; reorganize; create; form; construct; assemble; give; give me; give us; show; show me; load; deposit; carry; stack; pile; pile up; rest; position; locate; stash; park; install; mount; throw; toss; deliver; hand; station; situate; insert; send; pass; haul; haul over; carry over; bring over; move over; take; stand; gather; collect; group; assign; put down; set down; lay down; drop off; situate; return; lean; nestle; plant; place down; get me; make me; hold; seat; perch; keep hold of; position down; transport; settle; dispatch; re-stack; restack; stow; line up; tuck; fit; squeeze; wedge in; lob; whack; bung; slap; slot in; superimpose; hop; flip; roll; house; store; lodge; leave me; bring me; find me; layer; raise; lower; tidy; sort; clump; unite; combine; join
MAKE: make
PUTTING: putting; placing; moving; stacking; setting; getting; bringing; laying; having; keeping; leaving; dropping; building; making; seeing; letting; positioning; sticking; popping; piling; arranging; leaving
TAKE: take; grab; lift; pick; pick up; fetch; grasp; get; use; find; locate; go get; lift up; look for; seize; get hold of; search for; remove; reach for; choose; select
OFF: off; off of; from; out of; from on top of; from off; from the top of; off the top of; from out of; out from; from in; from inside; down from; up off; up from; from above; from atop
CARRY: supports; carries; holds; support; carry; hold; bears; bear; carrying; supporting; holding; bearing
CLEARS: clear; empty; vacate; uncover; free up; clear off; clear out; clean off; free; clear up; empty out; evacuate; expose; bare; clean; clear away; strip; clean out; clean up; tidy up; unblock; unbury
CLEAR: cleared; cleared out; emptied; emptied out; vacated; cleared off; cleaned; cleaned out; cleared away; freed; freed up; clear; empty; free; bare; vacant; unoccupied; uncovered; clean; exposed; unobstructed; clear on top; free on top; empty on top; deserted; uncluttered; blank; visible from above; open on top; bare on top; topless; unburdened; untouched on top; with nothing on top; with nothing on it; with nothing in it
HAS: has; have; contains; contain; holds; hold; containing; includes; include; having; houses; house; gets; get; with; receives; receive; accommodates; accommodate; hosts; host; consists of; consist of; is made of; is made up of; comprises; comprise; carries; carry; stores; store; features; feature; needs; need; wants; takes; take; keeps
COVERED: covered by; topped by; covered with; topped with; crowned by; crowned with; occupied by
COVER: cover; top; crown; cap
EXCEED: exceed; be more than; go over; go above; have more than; exceeds; go beyond
REMOVE: remove; take off; get rid of; take away; lift off; clear away; clear off; lift away; move away; take down; move
WHATIS: whatever is; whatever 's; what is; what 's; everything that is; anything that is; all that is; everything which is; everything; anything; whatever; all; all the blocks; all blocks; the blocks; the block; the stuff; whatever stands; whatever sits
COMEOFF: come off; go; go away; come down; be removed; get off; be taken off; be cleared away; be moved away; be moved
NUMBEROF: number of; count of; amount of
STARTWITH: start with; begin with; start from; start
ADD: add; continue with; next add; put
FINISHWITH: finish with; end with; finish off with; top it off with; top off with; finally; conclude with; close with
THAN: than
THROUGH: through; thru; up to; to
DARE: dare; you dare; ever; ever dare; even think of; think of; even think about; think about
NOTTHECASE: not the case; not to be; never the case
PLEASEME: please me; delight me; make me happy; make my day; mean a lot; help; help me; suit me; suit us; please us; be my pleasure; make us happy; be a great help; help us; help a lot; be a relief
SUPPORTED: supported by; carried by; held by; held up by
FIRST: first; to start with; to begin with; initially; at first
LASTLY: last; finally; lastly
BEFORE: before; after; until; once; when; whenever; unless; if; otherwise; provided; because; else; during; in case; as soon as; as long as; instead; rather; sooner; later
CORRECTION: no wait; no sorry; wait no; i mean; i meant; or rather; make that; no make that; scratch that; actually make that; no i meant; sorry i meant; wait i meant; oops i meant; no i mean; sorry i mean; sorry no; i mean to say; that is to say; no no; er no; uh no; um no; no wait a second; hang on; hold on; no actually; actually no; no not that; my mistake; my bad; wait sorry; oh no; oops no; strike that; forget that; no hang on; no hold on; or better; even better; or actually; wait actually; no rather; oops sorry; oh wait; no oops
CORRECTION1: wait; sorry; no; oops; rather; correction; nope; whoops; better; actually
INSTEADOF: instead of; rather than; as opposed to; in place of; in lieu of
INSTEAD: instead
DIRECTLY: directly; immediately; straight; right; exactly; just; squarely
NOTDIRECTLY: not directly; not immediately; not right; not straight
ALONE: alone; by itself; all by itself; all alone; on its own; all on its own; by themselves; on their own; to itself; all to itself; solo; in isolation
TOGETHER: together; all together
SAME: same; one; single; common; shared; the very same
DIFFERENT: different; separate; distinct; their own; its own; another; two different; three different; various
SHARE: share; shares; share together; sharing
NEIGHBORS: neighbours; neighbors; adjacent; side by side; neighboring; neighbouring; next door
TOWER: tower; pile; stack; column; heap; pillar; totem; skyscraper
ROWNOUN: row; line; sequence; order; series; lineup
UPWARDS: from bottom to top; bottom to top; from the bottom up; from the bottom to the top; bottom up; bottom first; from bottom up; from the bottom; starting from the bottom; starting at the bottom; lowest first; upwards; beginning at the bottom; in order from bottom to top; from the ground up; from base to top; base to top; starting at the base; going up; from low to high; read from the bottom; upward; bottom-up; bottom-to-top; from the base up; bottom to the top; counting from the bottom; ordered from bottom to top
DOWNWARDS: from top to bottom; top to bottom; from the top down; from the top to the bottom; top down; top first; from top down; from the top; starting from the top; starting at the top; from above; highest first; downwards; beginning at the top; in order from top to bottom; going down; from high to low; read from the top; downward; top-down; top-to-bottom; counting from the top; ordered from top to bottom
RIGHTWARDS: from left to right; left to right; from the left to the right; starting from the left; left first; going right; in order from left to right; ordered from left to right; left-to-right
LEFTWARDS: from right to left; right to left; from the right to the left; starting from the right; right first; going left; in order from right to left; right-to-left
ATTOP: on top; at the top; at top; on the top; at the very top; on the very top; on the tippy top; at the tippy top; at the peak; as the top; as its top; on the very top of it all; on top of it all; up top; right on top; right at the top; at the tip; on very top; tops it
TOPOF: at the top of; the top of; at the very top of; top of; the very top of; at top of; on the very top of; the peak of
INMIDDLE: in the middle; in between; in middle; middle; between them; between the two; as the middle; in the center; in the centre; sandwiched between; sandwiched in between
ATBOTTOM: at the bottom; on the bottom; at bottom; at the very bottom; on the very bottom; at the base; as the base; at base; as its base; as the bottom; as a base; underneath it all; right at the bottom; on bottom; at the foot; as the foundation; as foundation; below everything
BOTTOMOF: at the bottom of; the bottom of; on the bottom of; at the very bottom of; bottom of; the very bottom of; at the base of; the base of; on the very bottom of; at bottom of; the foot of; the foundation of; at the foot of; base of
TOPMOST: top; topmost; uppermost; highest; upper; top-most
LOWEST: bottom; lowest; bottommost; lower; base; bottom-most; undermost
FROMLEFT: from the left; from left; counting from the left; counted from the left; on the left; from the left side; from the left-hand side; starting from the left; starting at the left
FROMRIGHT: from the right; from right; counting from the right; counted from the right; on the right; from the right side; from the right-hand side; starting from the right; starting at the right
I: i; we; me; us
YOU: you
WANT: would rather have; would rather; want; wants; need; needs; would like; would love; would prefer; prefer; prefers; would want; would need; wish; wishes; ask for; am asking for; are asking for; asks for; asked for; request; requests; requested; require; requires; required; demand; demands; expect; expects; wanna; am needing; am looking for; are looking for; would appreciate; would rather have; am after; are after; would ask for; propose; suggest; proposes; suggests; would suggest; would propose; hope for; would be happy with; desire; desires; fancy; insist on; insists on; insist; insists; will have; would have; am wanting; would have liked; should like; should love; could use; could do with; must have; 'd; order; orders; am hoping for; hope; hopes; have to have; need to have; want to have; want to see; need to see; would like to see; would love to see; would like to have; would love to have; intend; intend to have; become; am trying to get; are aiming for; am aiming for; vote for; choose; opt for
THINK: think; guess; suppose; believe; reckon; figure; feel; imagine; would say; say; should think; would think; was thinking; were thinking; have decided; decided; was wondering; know what i want; would guess; am thinking
LOVEIT: would love it; would like it; would prefer it; would appreciate it; would be grateful; would be happy; would be glad; would be delighted; would be pleased; should be most obliged; would be obliged; would be much obliged; should be grateful; would be nice; would be great; would be so happy; would be thankful; would be very grateful; would be really happy; would be most grateful; would be super happy; would be thrilled; would be perfect
ASK: ask; trouble; bother; beg; request; invite; urge; instruct; tell
PERSONNOUN: boss; team; professor; doctor; friend; colleague; students; student; kids; children; class; customer; client; wife; husband; teacher; chef; director; manager; supervisor; mother; father; son; daughter; people; guests; folks; captain; nurse; surgeon; user; operator; examiner; audience; everyone; pupils; lab; experiment; task; drawing; recipe; specification; contract
MAKESURE: make it happen; make this happen; see whether you can; try to get; make sure; ensure; see to it; see; take care; arrange; arrange things; arrange it; make it so; guarantee; confirm; verify; make certain; see about; check; be sure; arrange the blocks; arrange everything; rearrange the blocks; rearrange things; rearrange everything; reorganize the blocks; reorganise the blocks; move things around; move the blocks around; move the blocks; move blocks around; shuffle things around; make it; get it; fix it; set it up; set things up; set everything up; sort it out; organize it; organize things; organise things; do it; manage; distribute the blocks; place the blocks; put the blocks; stack the blocks; spread the blocks; spread the blocks out; spread them; spread them out; order the blocks; try; see if you can; try and see; remember; note; be careful; have it; help me; show me how; proceed; spread things; spread things out; leave things; leave it; get things; get everything; configure the blocks; configure things; reposition the blocks; tidy up
SOTHAT: so that; so; that; until; such that; in such a way that; in a way that; as such that; to the point where; so as; till
GOOD: obliged; indebted; thankful; happy; glad; delighted; grateful; satisfied; pleased; thrilled; done; important; necessary; essential; crucial; vital; required; needed; imperative; desirable; desired; best; requested; time; critical; mandatory; preferable; preferred; great; nice; good; lovely; wonderful; perfect; fantastic; awesome; cool; better; super; ideal; splendid; helpful; swell; brilliant; fine; marvelous; marvellous; excellent; amazing; super important; very important; really important; absolutely necessary; paramount; compulsory; hereby requested; fabulous; fab; sweet; neat; dandy; a good idea; a pleasure; a treat; kind; terrific; ace; tops; appreciated; much appreciated
GOAL: goal; task; aim; job; plan; target; objective; mission; order; instruction; final state; end state; target state; goal state; final arrangement; final configuration; target configuration; required end state; desired state; result; setup; arrangement; configuration; layout; request; idea; wish; required state; desired end state; desired result; desired configuration; desired arrangement; state; end result; outcome; assignment; final goal; target arrangement; final layout; target layout; exercise; final setup; challenge; brief; command; todo; to do; final result; desired outcome; goal configuration; end configuration; requirement; specification; spec; final order; stack; tower; vision; dream
LET: let; let us; lets; have; make
SWAP: swap; exchange; switch; interchange; trade; swop; switch around; swap around; flip; reverse
SWAPPED: swap places; swap positions; trade places; change places; switch places; exchange places; swap; swapped; switched; trade positions; switch positions; change positions; exchange positions; the other way round; the other way around; swap spots; swap over; change over; exchanged; interchanged; reversed
WHERE: where; wherever; whichever place; the place where; the spot where; to where; the position where
NOW: now; currently; at the moment; right now; at present; presently; already; today; is now; just now
TURN: turn; flip; invert; reverse; upend; turn around
UPSIDEDOWN: upside down; over; around; on its head; upside-down; the other way up; the other way round; the other way around; in reverse; in reverse order; reversed; inverted; round
ASIS: as it is; as they are; as is; alone; where it is; where they are; unchanged; untouched; in place; as they were; as it was; where they stand; where it stands; the same; as before; undisturbed; unmoved; in its place; in their places; where it was; as it stands; as they stand; in peace; intact; in its current place; in their current places; in position; still; in their place; where it currently is; where they currently are; exactly where it is; exactly where they are; the way it is; the way they are; right where it is; right where they are; at its place; at their places
KEEP: leave; keep; let; have
DONTTOUCH: do not touch; do not move; do not disturb; do not change; do not alter; without moving; without touching; without disturbing; without changing; do not shift; don't touch; don't move; not touching; not moving
DONTCARE: wherever; do not care about; do not matter; does not matter; is up to you; are up to you; is irrelevant; are irrelevant; is not important; are not important; do not mind about; is your choice; doesn't matter; don't matter; do not care; does not matter to me; do not matter to me; can go anywhere; can be anywhere; may be anywhere; may go anywhere; can stay wherever; can go wherever; goes anywhere; go anywhere; anywhere; can stand anywhere; is your call; are your call; can go wherever you like; can be wherever
ANYORDER: in any order; in whatever order; the order does not matter; order does not matter; in no particular order; any order; order irrelevant; the order is irrelevant; no matter in which order; the order is up to you; whichever order; in any order you like; no matter where; no matter which; no matter the order; no matter what order; regardless of order; in an arbitrary order; in arbitrary order; whatever the order; i do not care which; i do not care which ones; i do not care in which order; i do not care about the order; i do not care where; which ones does not matter; it does not matter which; does not matter which; does not matter where; anywhere; whichever; whichever ones; no matter which ones; order unimportant; the order is not important; any will do; any ones
TALLEST: tallest; highest; biggest; largest; longest; fullest
SHORTEST: shortest; lowest; smallest; emptiest; least tall
EMPTYNOW: empty; free; vacant; unoccupied
SAMENOW: the same as now; as now; like now; the same as it is now; as it is now; everything as it is; everything the same; the same as before; the same as currently; same as now; same as it is; just like now; exactly like now; exactly as now; the current state; the current arrangement; the way it is now; the same arrangement; same arrangement; same arrangement as now; everything as it is now; the same
BACK: back
HIGH: high; tall; big; in height; up; deep
HIGHER: higher; taller; bigger
PER: per; a; for each; to a
BETWEEN: between
AS: as; like; than; to
INPLACE: in; into; inside; to; at; within; onto; on; on to; over to; over at; over in; over on; down in; down on; down at; up on; upon; across to
TOSIDE: on; to; at; onto; on to; over to; over on; along
OFOF: of; in; on; from; at; for
OF: of; from
POSS: 's
AVOID: avoid; refrain from; prevent
ANYWHEREBUT: anywhere but; anywhere except; anywhere other than; in any stack but; in any stack except; in any place but; not anywhere but; in any stack other than; in any place except; wherever but
POSSESSIVE: its; his; her; the
OUTOF: out
LIKE: like
ADJ: big; nice; high; tall; little; small; single; new; beautiful; great; huge; pretty
NEXTUP: next; above that; on that; on top of that; after that; over that; next up
ONIT: on it; above it; on top of it; over it
ABOVETHAT: on that; above that; on top of that; over that
THANKSFOR: thank you for; thanks for
TOSEE: to see; to have; to get
NOTTOUCH: touching
HEIGHT: height; tallness
BLOCKSOUT: blocks out; blocks out evenly; blocks; blocks evenly
SATISFY: satisfy; fulfil; fulfill; meet; be
LIKEWISE: also; likewise; as well; too; similarly
SAMEFOR: same for; the same for; same goes for; likewise for; the same goes for; ditto for
REVERSE: reverse; invert; upend; flip
PERMITTED: permitted; allowed; acceptable; okay; ok; right; good
NOTTIME: under no circumstances; at no time; in no case; on no account; by no means
PLAINUP: on
IN: in; into; to; inside; at
ITSELFIN: in it; in them; on them; in there; inside; inside it; on it; there
FURTHEST: furthest; farthest; most
ELSEWHERE: elsewhere; somewhere else; anywhere else; someplace else; away; to another place; to another stack; to a different place; to a different stack; in another stack; in a different stack; in another place; in a different place; on another stack; on a different stack; on another place; on a different place
ONLY: only; solely; exclusively; just
LETUS: let us; let us do; let us go with; let us go for; let us try; let us have; let us try and get; we would better; we had better; shall we; we had better; let me
MODAL: can; could; would; will; may; might; shall
MIND: be persuaded to; be able to; be inclined to; mind; be so kind as to; be so kind and; be so good as to; be so kind to; be kind enough to; be good enough to; be able to; be willing to; manage to; try to; be a dear and; do me a favor and; do me a favour and; do me the favour and; be so nice to; be so nice and; be a darling and; be a sweetheart and; go ahead and; help me; possibly; be so nice as to; care to; trouble yourself to; go and; do it so that
WHATIWANT: what i want; what i need; what i would like; what we want; what we need; all i want; all i need; all we need; all we want; what i'm after; what i am after; what i would like you to do; what i want you to do; all i ask; what i am trying to say; what i mean; what i would like to see; what we would like; what i'd like; what is wanted; what is needed; what needs to happen; what has to happen; what should happen; here is what i want; this is what i want; this is what i need; here is what i need; here is the plan; this is the plan; here is my wish; do it like this; do this; do the following; like this; the following
IFNICE: if you could; if you would; if you can; if we could have; if we had; if; if you were to; if i could have; if i could get; if we could get; if i could see
GIVENFOR: for; per; as per; according to; as; to satisfy; in accordance with; following; given; thanks to; on behalf of; in the name of; in honour of; on the orders of
DISCUSSED: discussed; agreed; planned; requested; mentioned; promised; instructed; specified; stated; described; required; said; noted; follows
STEP: step; part; phase; number; task; instruction; rule; condition; requirement; constraint; point; item; stage; move
END: end; side; edge; hand side; part
"""  # noqa: E501

#: Words that are right as they are, and none of those above with a slip.
_NO_SLIPS: Final = """
 grain tin bed glue line back ink pine bin can there here half mean base peak saw see said rod tail
 tall table cable able lose love loves like alike black slack snack track stick sticks think thing
 bake rake lake hand land sand sound round ground found bound mound brown grown green greens grin
 wall fall tell sell top tops stop step shop shape nod never lever left lift loft life one none tone
 done gone bone hate hates late gate wrong bad horrible awful terrible doubts doubt deny denies
 refuse refuses forbid forbidden prohibited dislike dislikes if unless before after until when while
 once since instead except only alone almost nearly half mostly partly third quarter either neither
 turn turns cancel undo stop ignore forget fast past last list lost cost least east beast blew glue
 near nearby close far apart high higher low lower light dark white whitish gold golden silver tan
 teal lime navy beige maroon olive turquoise indigo amber coral crimson scarlet rose ruby plum lilac
 aqua azure bronze copper cream peach salmon magenta grey gray violet pot pat pit pet bat bit but
 bug big bag leg log lag sat sit set sad mad bed bid bold cold fold told hold gold sold rolled
 where were wore ware ever even every very fit fits suit suits book books bought brought boat
 coat goat great greet street tree trees free three through throw though tough rough clean clear
 cleared dear hear near fear year years tear bear beer deer peer pair pear pare care cares cart
 part parts port sort sorts short shirt tile tie tied mile smile while
"""


def _written_out(words: str) -> str:
    for short, long in (("don't", "do not"), ("n't", " not"), ("'m", " am"), ("'d", " would"),
                        ("'ll", " will"), ("'re", " are"), ("'s", " 's")):  # fmt: skip
        words = words.replace(short, long)
    return words


def entries() -> Iterator[tuple[str, tuple[str, ...], str]]:
    """Kind, words, and what they stand for, of every entry."""
    for line in _WORDS.replace("\n ", " ").strip().splitlines():
        kind, _, listed = line.partition(": ")
        for entry in listed.split("; "):
            said, _, meant = entry.strip().partition("=")
            if said:
                yield kind, tuple(_written_out(said).split()), meant or said


#: Colours beside those of :data:`scene_graph.COLORS`.
MORE_COLORS: Final = frozenset({
    "white", "gold", "golden", "silver", "tan", "teal", "lime", "navy", "beige", "maroon",
    "olive", "turquoise", "indigo", "amber", "coral", "crimson", "scarlet", "rose", "ruby",
    "plum", "lilac", "aqua", "azure", "bronze", "copper", "cream", "peach", "salmon", "violet",
    "gray", "grey",
})  # fmt: skip
#: Words that deny what stands beside them, so that nobody may leave them out.
_BAD: Final = """
 forbidden prohibited banned wrong false bad error mistake nonsense avoid cancel undo ignore
 forget hypothetically supposedly allegedly except unless against contrary opposite reverse danger
 dangerous illegal impossible refused refuse denied deny reject rejected abandon abort stop
 previously formerly once usually sometimes rarely seldom hardly barely scarcely almost nearly
 past history old before yesterday earlier hate hates doubt doubts dislike dislikes wrongly
 instead unlike unwanted undesired none nope nah not no never nor neither joke joking kidding
 anything-but bogus fake fail failed failure incorrect invalid untrue lie lies question
"""
BAD: Final = frozenset(_BAD.split())
#: The kind of word that may be left out.
FILLER: Final = "FILLER"
NO_SLIPS: Final = frozenset(_NO_SLIPS.split())
