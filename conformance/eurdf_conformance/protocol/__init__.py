"""The messages between the runner and a reader, and their JSON Schemas: chapter The parser protocol."""
