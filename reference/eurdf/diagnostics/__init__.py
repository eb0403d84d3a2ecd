"""Diagnostics: codes, places, messages, and how they are shown."""

from eurdf.diagnostics.diagnostic import Diagnostic, Diagnostics, FileError, Hint, Place, Proposals
from eurdf.diagnostics.fix import Edit, Fix, misspelt, renamings
from eurdf.diagnostics.registry import REGISTRY, Phase, Rule, Severity
from eurdf.diagnostics.wording import did_you_mean, enumerated, plural, quoted

__all__ = [
    "REGISTRY",
    "Diagnostic",
    "Diagnostics",
    "Edit",
    "FileError",
    "Fix",
    "Hint",
    "Phase",
    "Place",
    "Proposals",
    "Rule",
    "Severity",
    "did_you_mean",
    "enumerated",
    "misspelt",
    "plural",
    "quoted",
    "renamings",
]
