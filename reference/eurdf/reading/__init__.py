"""Reading: YAML and XML as trees that remember where each part stands."""
