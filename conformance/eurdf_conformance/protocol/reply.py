"""What a Python reader replies to `load`: answers without the id of their request, which `serve` fills in."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Issue, Rejected, Skipped, Unsupported

NO_ID = 0


def accepted(robot: CanonicalRobot | Mapping[str, Any] | None = None, issues: Iterable[Issue | str] = ()) -> Accepted:
    """The robot is read.

    Args:
        robot: The canonical description, as a value or as plain data; None where structure is not claimed.
        issues: What is wrong with it all the same, each at least a sentence.

    Raises:
        ValueError: Plain data that is no canonical description.
    """
    if isinstance(robot, Mapping):
        robot = CanonicalRobot.model_validate_json(json.dumps(robot))
    return Accepted(id=NO_ID, robot=robot, issues=_issues(issues))


def rejected(*issues: Issue | str) -> Rejected:
    """The description is wrong.

    Args:
        issues: Why, each at least a sentence.
    """
    return Rejected(id=NO_ID, issues=_issues(issues))


def unsupported(feature: str, reason: str = "") -> Unsupported:
    """The reader lacks a feature that the description uses.

    Args:
        feature: The feature, in a word or two.
        reason: For people.
    """
    return Unsupported(id=NO_ID, feature=feature, reason=reason)


def skipped(reason: str) -> Skipped:
    """The reader would rather not.

    Args:
        reason: Why.
    """
    return Skipped(id=NO_ID, reason=reason)


def _issues(issues: Iterable[Issue | str]) -> list[Issue]:
    return [Issue.model_validate({"message": issue}) if isinstance(issue, str) else issue for issue in issues]
