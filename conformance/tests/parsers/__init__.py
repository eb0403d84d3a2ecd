"""Misbehaving parsers for the tests of the suite itself. Each has one error, which its docstring states.

- `process`: processes that break the pipe, the line or the protocol; `sessions` starts them.
- `python_parsers`: Python objects that are served badly, or are not parsers.
- `case_parser`: parsers that know the answers to the cases, and go wrong at two of them.
- `spoilt`: the answers of the oracle, with each change that the schemas allow.
- `relations`: parsers whose answers depend on what must not matter.

Parsers that misread or misunderstand a robot are in `mutants`.
"""
