"""The examples of every certification: ``python -m eurdf_conformance.properties.freeze`` writes `frozen.json`.

Certification never draws: what Hypothesis makes of a seed may change from one of its versions to the next, and with it
what a certificate certifies. So this is run when the strategies change, and its outcome is kept.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.properties.example import FROZEN, Example, frozen_text
from eurdf_conformance.properties.features import features
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.strategies.mechanisms import mechanisms

#: Numbers of examples drawn and kept, for each version.
DRAWN, KEPT = 1200, {"1": 30, "2": 40, "2.1": 40}

#: How many examples show each feature, if possible.
_WANTED = 3


def main() -> None:
    """Write the file."""
    examples = {version: chosen(drawn(version), KEPT[version]) for version in VERSIONS}
    FROZEN.write_text(frozen_text(examples), encoding="utf-8")
    for version, kept in examples.items():
        count = Counter(feature for example in kept for feature in features(example.mechanism))
        sys.stdout.write(f"version {version}: {len(kept)} mechanisms, {dict(sorted(count.items()))}\n")


def drawn(version: Version) -> list[Example]:
    """Many examples, about half of them with closures."""
    found: list[Example] = []
    either = st.sampled_from([0, 1]).flatmap(lambda closures: mechanisms(version, closures))

    @settings(
        max_examples=DRAWN,
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(either, st.integers(0, 10**6))
    def draw(mechanism: Mechanism, seed: int) -> None:
        found.append(Example(mechanism=mechanism, seed=seed))

    draw()
    return found


def chosen(examples: Sequence[Example], count: int) -> list[Example]:
    """Examples chosen one after the other, each for the features that were rarest so far."""
    left, seen = list(examples), Counter[str]()
    kept: list[Example] = []
    used = {id(example): features(example.mechanism) for example in left}
    while len(kept) < count:
        best = max(left, key=lambda example: sum(max(0, _WANTED - seen[each]) for each in used[id(example)]))
        left.remove(best)
        kept.append(best)
        seen.update(used[id(best)])
    return kept


if __name__ == "__main__":
    main()
