"""The robots of the published collection, and those here that correspond to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Published:
    """A robot of theirs.

    Attributes:
        name: That `load` of theirs knows.
        folder: Of its files, in `robots`.
        ours: The robot here.
        size: What their loader makes of it with Pinocchio 3.4: velocities, rows of the closures, actuated velocities;
            or words of the error that it raises.
        note: What is unlike.
        root: The root that their loader gives it.
    """

    name: str
    folder: str
    ours: str
    size: tuple[int, int, int] | str
    note: str = ""
    root: Literal["fixed", "floating"] = "fixed"


_SPRINGS = "ours has the four leaf springs"
_OPEN = "none was found that closes the loops of theirs"
_FLOATS = "theirs floats"
_UNPUBLISHED = "made by `TalosClosed`"

PUBLISHED = (
    Published("5bar", "5bar_linkage", "five_bar", (6, 6, 2), "theirs has a joint more, which nothing controls"),
    Published("5bar3d", "5bar_linkage_iso3d", "five_bar_3d", (5, 3, 2)),
    Published("5bar6d", "5bar_linkage_iso6d", "five_bar_6d", (8, 6, 2)),
    Published("cassie_leg", "cassie_like", "cassie_leg", (19, 12, 5), "ours has the two leaf springs"),
    Published("digit_leg", "digit_like", "digit_leg", (27, 18, 6)),
    Published("digit_2legs", "digit_like_2legs", "digit_2legs", (54, 36, 12), _SPRINGS, "floating"),
    Published("digit_2legs_6D", "digit_like_2legs_6D", "digit_2legs", (54, 36, 12), _SPRINGS, "floating"),
    Published("disney_leg", "disney_like", "disney_leg", (33, 18, 6), _FLOATS, "floating"),
    Published(
        "disney_2legs",
        "disney_robot",
        "disney_2legs",
        (56, 36, 12),
        "a joint with a misspelt name stays revolute in theirs; `eurdf check` reports it",
        "floating",
    ),
    Published("kangaroo_leg", "kangaroo_like", "kangaroo_leg", (63, 66, 6), _OPEN),
    Published("kangaroo_2legs", "kangaroo_like_2legs", "kangaroo_2legs", (78, 90, 12), _OPEN + "; ours floats"),
    Published("delta", "robot_delta", "delta", (14, 18, 2), "theirs has two motors and moves in five ways"),
    Published("talos_2legs", "", "talos_2legs", "No module named", _UNPUBLISHED),
    Published("talos_2legs_6d", "", "talos_2legs_6d", "No module named", _UNPUBLISHED),
    Published(
        "talos_2legs_urdf",
        "true_talos_2_legs",
        "talos_2legs",
        "robot.urdf does not contain a valid URDF",
        "the URDF of theirs has another name: `eurdf.load(folder, urdf=…)` reads it",
        "floating",
    ),
    Published(
        "talos_only_leg",
        "",
        "talos_2legs",
        "Robot talos_full_closed does not exist",
        "lock the upper body with `eurdf.lock`",
    ),
    Published("talos_leg", "talos_like", "talos_leg", (13, 6, 6)),
    Published("wl16_leg", "wl16_like", "wl16_leg", (42, 30, 6)),
    Published("battobot", "battobot_6d", "battobot", (54, 36, 12), root="floating"),
)
