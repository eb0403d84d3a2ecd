"""Claims about OpenUSD."""

from __future__ import annotations

from pxr import Plug, Tf, UsdPhysics

from benchmarks.claims.expectation import expect


def mimic_joints() -> str:
    """Whether a schema of USD physics has a mimic joint."""
    plugin = Plug.Registry().GetPluginForType(Tf.Type.Find(UsdPhysics.Joint))
    types = sorted(plugin.metadata["Types"])
    found = [name for name in types if "mimic" in name.lower() or "gear" in name.lower() or "coupl" in name.lower()]
    return expect(len(types) > 10 and not found, f"{len(types)} types of USD physics, of mimic joints: {found}")
