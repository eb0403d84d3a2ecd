"""What the answers of a parser come to: a verdict on each item, and a result at each level.

An item is one question: one case, or one property, at one level. The order is `verdict` (the words), `result` (an item
and its verdict), `run` (all results of one run of the suite), `level_result` (what they come to at one level), and
`known_failures` (what a parser's author expects to fail).
"""
