"""The messages between the runner and a parser, and their JSON Schemas: chapter The parser protocol."""
