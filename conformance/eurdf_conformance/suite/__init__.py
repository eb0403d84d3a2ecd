"""What pytest runs: every case and every property, at every level that a reader claims.

`item` says what there is to ask, `conversation` asks, `judge` says what the answers come to; none of them knows of
pytest, so that whoever has a reader at hand can use them. `plugin` and the ``test_`` modules are the layer of pytest.
"""
