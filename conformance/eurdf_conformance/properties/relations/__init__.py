"""Metamorphic relations: a parser's answers on one robot determine its answers on another.

No one needs to know what is right: a parser is compared with itself.
"""
