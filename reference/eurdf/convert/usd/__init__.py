"""USD with the UsdPhysics schema."""
