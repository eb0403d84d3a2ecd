"""The conformance suite of Extended URDF: it certifies any parser, in any language, through one protocol.

Data flows one way: `corpus` and `properties` make cases, `oracle` says what is right, `runner` asks the parser through
`protocol`, `comparison` compares, `suite` is what pytest runs of all this, `judging` counts, `certificate` writes it
down. Nothing here imports the reference but the adapter of it, which is a parser like any other.
"""
