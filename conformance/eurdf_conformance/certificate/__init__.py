"""What a run of the suite comes to, written down so that anyone can read it, show it, and run it again.

`certificate` is the value, `issue` draws it from a run, `write` puts it into a folder as JSON, as a page (`report`) and
as a badge (`badge`); `comparison_page` shows several certificates side by side.
"""
