"""Advice: what the format allows but is usually a mistake, with codes of this parser (EU-DIA-006)."""
