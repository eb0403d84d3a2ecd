"""Relations: what a reader says of one robot follows from what it says of another.

No one needs to know what is right: a reader is compared with itself.
"""
