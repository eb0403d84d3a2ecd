"""Verdicts: how the answers of a parser are judged, item by item and level by level.

An item is one question: one case, or one property, at one level. The order is `verdict` (the words), `result` (an item
and its verdict), `run` (all results of one run of the suite), `level_result` (pass or fail of one level), and
`known_failures` (what a parser's author expects to fail).
"""
