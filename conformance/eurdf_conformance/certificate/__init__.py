"""Certificates: the result of a run of the suite, which anyone can read, publish and reproduce.

`certificate` is the value, `issue` draws it from a run, `write` puts it into a folder as JSON, as a page (`report`) and
as a badge (`badge`); `comparison_page` shows several certificates side by side.
"""
