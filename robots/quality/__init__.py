"""Quality checks for robots of the collection: ``python -m robots.quality [NAME|FOLDER …] [--json]``.

The checks, in `verdict.RULES`, are the same for a robot of the collection and for any other folder. Each takes a
`candidate.Candidate` and returns its errors, one sentence each.
"""
