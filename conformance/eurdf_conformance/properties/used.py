"""The features of the format that the files of a query use."""

from __future__ import annotations

from eurdf_conformance.corpus.features import features_of_files, features_of_robot
from eurdf_conformance.feature import Feature
from eurdf_conformance.properties.query import Query
from eurdf_conformance.properties.truth import truth


def features_of_query(query: Query) -> frozenset[Feature]:
    """The features that the files of a query use."""
    stated = features_of_files(query.files.description, query.files.urdf)
    return stated | features_of_robot(truth(query.mechanism, query.version).canonical())
