"""Parts of the importer of MJCF."""
