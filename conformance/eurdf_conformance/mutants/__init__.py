"""Mutants: the reference reader, each time with one thing broken, to see that the suite would tell.

A mutant is a function that returns a deviation: a context manager in which one function of the reference is another.
Its docstring says what is broken, and its decorator which clause. Each is a reader, such as
``--parser=eurdf_conformance.mutants:angular_rows_first``. `kills` looks for a case or a property that catches it and
cites its clause; the tests ask that there is one in each version. ``pytest tests/conformance/test_mutants.py -k NAME``
asks it for one mutant.

How they are broken: those of `accepting` and `silent` lack the rule of one diagnostic each, and the former build no
robot of what they accept, as those of `going_on` do; those of `refusing` have a rule too many; the other modules, by
topic, misread, with `deviation` and `of_the_reference` for their tools.
"""

from eurdf_conformance.mutants.catalogue import MUTANTS

# By name, so that a parser string finds each.
globals().update(MUTANTS)

__all__ = ["MUTANTS"]
