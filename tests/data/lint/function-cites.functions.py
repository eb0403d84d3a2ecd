"""What the clauses of the fixtures are enforced by."""


class Comb:
    """A comb: EU-TST-001 and -002."""

    def comb(self) -> None:
        """EU-TST-009: hair is straight."""
