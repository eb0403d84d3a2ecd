"""What pytest runs: every case and every property, at every level that a parser claims.

`item` says what there is to ask, `conversation` asks, `judge` says what the answers come to; none of them knows of
pytest, so that whoever has a parser at hand can use them. `plugin` and the ``test_`` modules are the layer of pytest.
"""
