"""Robots in the formats of others: each format states what it loses."""
