"""A mechanism in the formats of others: each export says what it lost."""
