"""What a Python parser replies to `load`: answers without the id of their request, which `serve` fills in."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from eurdf_conformance.protocol.error_text import error_text, not_finite
from eurdf_conformance.protocol.message import Accepted, Answer, CanonicalRobot, Issue, Rejected, Skipped, Unsupported

NO_ID = 0

_Reply = TypeVar("_Reply", bound=Answer)


class WrongReply(Exception):  # noqa: N818 - it says what the reply is
    """The adapter made an invalid answer; the text says what is wrong.

    It is not a ValueError, because many parsers raise that for invalid files, and adapters turn it into a rejection.
    """


def accepted(robot: CanonicalRobot | Mapping[str, Any] | None = None, issues: Iterable[Issue | str] = ()) -> Accepted:
    """The robot is read.

    Args:
        robot: The canonical description, as a value or as plain data; None if structure is not claimed.
        issues: Warnings and errors, each a sentence or an `Issue`.

    Raises:
        WrongReply: The robot is not a canonical description, or an issue is invalid.
    """
    if isinstance(robot, Mapping):
        robot = _canonical(robot)
    own = robot.own if isinstance(robot, CanonicalRobot) else {}
    for pointer in not_finite(own, "/robot/own"):
        raise WrongReply(f"in accepted(): {pointer}: JSON has no NaN or infinity")
    return _reply(Accepted, robot=robot, issues=_issues(issues))


def rejected(*issues: Issue | str) -> Rejected:
    """The description is wrong.

    Args:
        issues: The reasons, each a sentence or an `Issue`.

    Raises:
        WrongReply: An issue is invalid.
    """
    return _reply(Rejected, issues=_issues(issues))


def unsupported(feature: str, reason: str = "") -> Unsupported:
    """The parser lacks a feature that the description uses.

    Args:
        feature: The feature, a `Feature` that the parser lists in `lacks`.
        reason: An explanation for people.

    Raises:
        WrongReply: One of them is not a string.
    """
    return _reply(Unsupported, feature=feature, reason=reason)


def skipped(reason: str) -> Skipped:
    """The parser chooses not to answer.

    Args:
        reason: The reason.

    Raises:
        WrongReply: The reason is not a string.
    """
    return _reply(Skipped, reason=reason)


def _canonical(robot: Mapping[str, Any]) -> CanonicalRobot:
    try:
        return CanonicalRobot.model_validate_json(json.dumps(robot))
    except ValidationError as error:
        raise WrongReply(f"in accepted(): {error_text(error, '/robot')}") from None
    except (TypeError, ValueError, RecursionError) as error:  # a set, an array of numpy, what contains itself
        raise WrongReply(f"in accepted(): /robot is not plain data: {error}") from None


def _issues(issues: Iterable[Issue | str]) -> list[Issue]:
    return [Issue.model_validate({"message": issue}) if isinstance(issue, str) else issue for issue in issues]


def _reply(kind: type[_Reply], **members: Any) -> _Reply:
    try:
        return kind(id=NO_ID, **members)
    except ValidationError as error:
        raise WrongReply(f"in {kind.model_fields['outcome'].default}(): {error_text(error)}") from None
