"""Properties: what holds of any parser and any mechanism, random ones and `families` whose mobility is known.

Data flows one way: `strategies` draw a `mechanism`, which is a plain value; `document`, `yaml_text` and `urdf` write
its two files; a `property` checks what a parser answers on them through the `harness`, alone or by a metamorphic
relation between two mechanisms (`relations`); `trying` tries a property on the frozen examples, and `explore` on as
many more as the user asks for.
"""

from eurdf_conformance.properties.catalogue import PROPERTIES

__all__ = ["PROPERTIES"]
