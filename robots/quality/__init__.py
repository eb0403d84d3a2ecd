"""What says when a robot is good enough for the collection: ``python -m robots.quality [NAME|FOLDER …] [--json]``.

The rules, in `verdict.RULES`, are the same for a robot of the collection and for a folder anywhere. Each looks at a
`candidate.Candidate` and says what is wrong with it, one sentence a fault.
"""
