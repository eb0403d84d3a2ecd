"""Fresh cases: drawn for each run, so that no parser can know them. The seed decides them, and the oracle the answers.

`draw` draws mechanisms with Hypothesis, in a process of its own; `fault` makes invalid files of valid ones; `case` is
what the suite asks about.
"""
