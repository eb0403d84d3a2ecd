"""Descriptions as text: generated, migrated, and with a configuration written into them."""
