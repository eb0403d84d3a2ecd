"""Reading: YAML and XML as trees with positions."""
