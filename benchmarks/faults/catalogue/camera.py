# SPDX-License-Identifier: Apache-2.0
"""What cameras, their drivers, the detector and the calibration do."""

from __future__ import annotations

from dataclasses import replace

from faults import damages as d
from faults import picture_damages as p
from faults.fault import CAMERA_PHASES, Fault, Injection, Parameters, Phase, Words
from faults.injections import All, Damaged, Restarted
from faults.modes import Change, Delay, Drop, Freeze, FreezeContent, Repeat, Swap
from faults.relay import Mode
from faults.topics import CAMERA, DEPTH, EXTRINSICS, IMAGE, INFO, LABELS

_SILENT: Words = (("camera", "scene graph"),)
#: By default nobody hears the labels: blocks are found in colour and depth.
_GIVEN_MASKS: Parameters = (("perception_node", "mask_source", "segmentation_topic"),)


def _lasting(name: str, what: str, topics: tuple[str, ...], mode: Mode, *words: str) -> Fault:
    """A fault of some camera topics that stays; ``words``: one of them must be said."""
    return Fault(name, what, Damaged(topics, mode), CAMERA_PHASES, (words,))


def _labels(name: str, what: str, mode: Mode, *words: str) -> Fault:
    """A fault of a detector whose labels are heard; it stays."""
    return replace(_lasting(name, what, (LABELS,), mode, *words), parameters=_GIVEN_MASKS)


def _passing(
    name: str, what: str, injection: Injection, seconds: float, phases: tuple[Phase, ...]
) -> Fault:
    return Fault(name, what, injection, phases, _SILENT, seconds, transient=True)


FAULTS = (
    # Streams that stay out
    _lasting("image-lost", "no colour image arrives", (IMAGE,), Drop(), IMAGE),
    _lasting("depth-lost", "no depth image arrives", (DEPTH,), Drop(), DEPTH),
    _labels("segmentation-lost", "no segmentation arrives where it is needed", Drop(), LABELS),
    _lasting("camera-info-lost", "no camera_info arrives", (INFO,), Drop(), INFO),
    _lasting("camera-lost", "nothing of the camera arrives", CAMERA, Drop(), "camera"),
    _passing(
        "camera-lost-3s", "nothing of the camera arrives for 3 s", Damaged(CAMERA, Drop()), 3.0,
        (*CAMERA_PHASES, Phase.EXECUTE),
    ),
    _passing(
        "depth-lost-5s", "no depth image arrives for 5 s", Damaged((DEPTH,), Drop()), 5.0,
        CAMERA_PHASES,
    ),
    _passing(
        "frames-lost", "two of three messages of each stream are lost for 4 s",
        Damaged(CAMERA, Drop(keep=3)), 4.0, CAMERA_PHASES,
    ),
    # Streams out of time
    _lasting(
        "images-late", "every image arrives 1 s late", CAMERA, Delay(1.0), "camera", "old"
    ),
    _lasting(
        "depth-late", "depth arrives 2 s after the other images", (DEPTH,), Delay(2.0),
        DEPTH, "stamps",
    ),
    _lasting(
        "images-out-of-order", "messages arrive in pairs, the second first", CAMERA, Swap(),
        "camera",
    ),
    _lasting("images-twice", "every message arrives twice", CAMERA, Repeat(2), "camera"),
    _lasting(
        "camera-frozen", "the same messages again and again, stamps and all", CAMERA, Freeze(),
        "camera", "stamp",
    ),
    _lasting(
        "picture-frozen", "the same picture with new stamps", CAMERA, FreezeContent(),
        "camera", "picture",
    ),
    _lasting(
        "stamps-constant", "all stamps are the same", CAMERA, Change(d.with_stamp(10**18)),
        "stamp", "old",
    ),
    _lasting("stamps-zero", "no stamps", CAMERA, Change(d.with_stamp(0)), "stamp", "old"),
    _lasting(
        "stamps-future", "stamps one minute ahead", CAMERA, Change(d.stamped(60.0)), "future"
    ),
    _lasting("stamps-past", "stamps one minute behind", CAMERA, Change(d.stamped(-60.0)), "old"),
    _lasting(
        "stamps-waver", "each stream has stamps of its own", CAMERA,
        Change(d.with_wavering_stamps()), "stamp",
    ),
    # Pictures
    _lasting(
        "image-black", "the colour image is black", (IMAGE,), Change(p.pixels(p.black)),
        "dark", "black", "colour", "exposure",
    ),
    _lasting(
        "image-white", "the colour image is white", (IMAGE,), Change(p.pixels(p.white)),
        "bright", "white", "colour", "exposure",
    ),
    _lasting(
        "image-noise", "the colour image is noise", (IMAGE,), Change(p.pixels(p.noise)),
        "colour", "reproduces", "noise", IMAGE,
    ),
    _lasting(
        "image-grainy", "noise of 20 grey levels", (IMAGE,), Change(p.pixels(p.grainy)),
        "colour", "reproduces", "noise", IMAGE,
    ),
    Fault(
        "image-mirrored", "colour is mirrored, depth is not",
        Damaged((IMAGE,), Change(p.pixels(p.mirrored))), CAMERA_PHASES,
        (("colour", "reproduces", IMAGE, "same pixels", "hides"),),
        unseen="equal towers on both sides look alike in a mirror, but for their colours",
    ),
    _lasting(
        "encoding-wrong", "the colour image is called bgr8", (IMAGE,),
        Change(p.of_encoding("bgr8")), "encoding",
    ),
    _lasting(
        "image-small", "the colour image is 128x128, the others are not", (IMAGE,),
        Change(p.of_size(128)), "128x128",
    ),
    _lasting("image-cut", "half of the colour image's data is lost", (IMAGE,), Change(p.cut_off),
             "bytes"),
    # Depth
    _lasting(
        "depth-millimetres", "depth in millimetres", (DEPTH,), Change(p.pixels(p.millimetres)),
        "depth",
    ),
    _lasting(
        "depth-nan", "depth without a value", (DEPTH,), Change(p.pixels(p.nothing_but_nan)), "depth"
    ),
    _lasting(
        "depth-zero", "depth is zero everywhere", (DEPTH,), Change(p.pixels(p.black)), "depth"
    ),
    _lasting(
        "depth-holes", "three of ten pixels have no depth", (DEPTH,), Change(p.pixels(p.holes)),
        "depth",
    ),
    _lasting(
        "depth-offset", "depth is 5 cm too small", (DEPTH,), Change(p.pixels(p.nearer(0.05))),
        "depth", "extrinsics", "calibrat",
    ),
    # Segmentation, where masks come from a detector
    Fault(
        "labels-shuffled", "other numbers for the same blocks, for good",
        Damaged((LABELS,), Change(p.pixels(p.labels_shuffled))), CAMERA_PHASES,
        (("segmentation",),), transient=True, parameters=_GIVEN_MASKS,
    ),
    _labels(
        "labels-scattered", "every pixel of a block has the label of some block",
        Change(p.pixels(p.labels_scattered)), "segmentation", "label", "reproduces",
    ),
    _labels(
        "labels-merged", "one label for all blocks", Change(p.pixels(p.labels_merged)),
        "segmentation", "label", "unknown", "cannot be seen", "no ", "beside",
    ),
    _labels(
        "labels-none", "the detector finds nothing", Change(p.pixels(p.black)),
        "no block", "not a block",
    ),
    _labels(
        "block-overlooked", "the detector overlooks one block", Change(p.pixels(p.lost_label)),
        "not a block", "not seen", "cannot be seen", "unknown", "no ", "in the air",
    ),
    # What stands in between, what is calibrated
    Fault(
        "camera-half-covered", "something stands before the left half of the camera",
        All((
            Damaged((IMAGE,), Change(p.pixels(p.covered(60)))),
            Damaged((DEPTH,), Change(p.pixels(p.covered(0.3)))),
        )),
        CAMERA_PHASES, (("hides", "hidden"),),
    ),
    _passing(
        "camera-covered-4s", "something stands before half of the camera for 4 s",
        All((
            Damaged((IMAGE,), Change(p.pixels(p.covered(60)))),
            Damaged((DEPTH,), Change(p.pixels(p.covered(0.3)))),
        )),
        4.0, CAMERA_PHASES,
    ),
    _lasting("info-uncalibrated", "camera_info without intrinsics", (INFO,),
             Change(p.without_intrinsics), "intrinsics", "calibrat"),
    _lasting("info-distorted", "the picture is not rectified", (INFO,), Change(p.distorted),
             "distort", "rectif"),
    _lasting("extrinsics-invalid", "a quaternion of zeros", (EXTRINSICS,),
             Change(p.no_rotation), "extrinsics"),
    _lasting("extrinsics-4cm-aside", "the calibration is 4 cm off to the side", (EXTRINSICS,),
             Change(p.moved_by(y=0.04)), "extrinsics", "calibrat"),
    _lasting("extrinsics-3cm-high", "the calibration is 3 cm too high", (EXTRINSICS,),
             Change(p.moved_by(z=0.03)), "extrinsics", "calibrat"),
    _lasting("extrinsics-turned", "the calibration is turned by 8 degrees", (EXTRINSICS,),
             Change(p.turned_by(8.0)), "extrinsics", "calibrat"),
    Fault(
        "extrinsics-never", "perception starts and no extrinsics arrive",
        All((Damaged((EXTRINSICS,), Drop()), Restarted("perception_node"))),
        (Phase.PERCEIVE,), (("extrinsics", "nothing has arrived from perception"),),
    ),
    # What no camera can tell
    Fault(
        "colours-exchanged", "red and blue are exchanged: bgr8 that is called rgb8",
        Damaged((IMAGE,), Change(p.pixels(p.red_and_blue_exchanged))), CAMERA_PHASES,
        (("unknown", "cannot be seen", "not seen", "no ", "exchanged"),),
        unseen="blocks of exchanged colours are other blocks to every camera",
    ),
)  # fmt: skip
