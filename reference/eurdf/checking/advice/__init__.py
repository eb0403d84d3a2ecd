"""Advice: what is within the rules of the format and yet is mostly a mistake, by codes of this parser (EU-DIA-006)."""
