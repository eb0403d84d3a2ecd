"""The cases: one fault each, or none, in folders ``cases/<topic>/<id>/`` that hold all there is to know of them."""
