"""Properties: what holds of any reader and any mechanism, random ones and `families` whose mobility is known.

Data flows one way: `strategies` draw a `mechanism`, which is a plain value; `document`, `yaml_text` and `urdf` write
its two files; a `law` says what holds of what a reader on the `bench` answers about them, by itself or by `relations`
between two mechanisms; `trying` tries a law on the frozen examples, and `explore` on as many more as are asked for.
"""

from eurdf_conformance.properties.catalogue import LAWS, PROPERTIES

__all__ = ["LAWS", "PROPERTIES"]
