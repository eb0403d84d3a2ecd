"""Mechanisms whose mobility is known for any number of links, since counting alone gives it.

Each module builds a few of a kind, at a configuration that is closed and not singular, and says their counts.
"""
