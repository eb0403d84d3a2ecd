"""Parsers behind the protocol: the reference, and two small examples to begin an adapter from."""
