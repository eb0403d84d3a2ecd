"""Strategies for random mechanisms: well conditioned, with numbers that read back exactly, and small once shrunk."""
