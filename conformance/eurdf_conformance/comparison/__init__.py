"""Compares expected values with the answers of a parser. The result is a list of differences, empty if they agree."""
