"""What the clauses of the fixtures are enforced by."""


class Comb:
    """A comb: EU-TST-001 and -002."""


def comb() -> None:
    """EU-TST-004: hair is straight."""
