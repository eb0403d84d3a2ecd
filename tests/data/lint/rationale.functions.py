"""What the clauses of the fixtures are enforced by."""


class Comb:
    """A comb: EU-TST-001."""
