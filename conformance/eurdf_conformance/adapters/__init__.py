"""Parsers that speak the protocol: the reference, and two small examples to start an adapter from."""
