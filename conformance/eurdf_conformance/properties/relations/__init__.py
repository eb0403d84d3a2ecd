"""Relations: what a parser says of one robot follows from what it says of another.

No one needs to know what is right: a parser is compared with itself.
"""
