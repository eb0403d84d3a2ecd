"""What pytest runs: every case and every property, at every level that a parser claims.

`item` lists the questions, `judging` asks them and judges the answers; neither depends on pytest, so other programs
can use them too. `plugin` and the ``test_`` modules are the layer of pytest.
"""
