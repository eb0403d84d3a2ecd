"""All mutants, by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType, ModuleType

from eurdf_conformance.mutants import (
    actuation,
    canonical_robot,
    closure_rules,
    closures,
    configurations,
    descriptions,
    frames,
    going_on,
    inertia,
    inertia_rules,
    joint_properties,
    joint_rules,
    joints,
    merging,
    mimics,
    near_names,
    odd_descriptions,
    other_programs,
    own_data,
    places,
    refusing,
    refusing_urdf,
    speaking,
    telling,
    urdf_elements,
    urdf_reading,
    velocities,
    version1,
    version1_joints,
    xml_reading,
    yaml_bounds,
    yaml_documents,
    yaml_scalars,
    yaml_styles,
)
from eurdf_conformance.mutants.accepting import ACCEPTING
from eurdf_conformance.mutants.descriptions import ALONE
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.own_data import OWN
from eurdf_conformance.mutants.silent import SILENT
from eurdf_conformance.mutants.urdf_table import BUT_FOR_SOME

_MODULES = (
    yaml_scalars,
    yaml_styles,
    yaml_documents,
    own_data,
    yaml_bounds,
    descriptions,
    version1,
    version1_joints,
    xml_reading,
    urdf_reading,
    urdf_elements,
    mimics,
    other_programs,
    frames,
    joint_properties,
    joint_rules,
    joints,
    merging,
    closure_rules,
    closures,
    velocities,
    inertia,
    inertia_rules,
    actuation,
    configurations,
    canonical_robot,
    going_on,
    refusing,
    refusing_urdf,
    telling,
    near_names,
    odd_descriptions,
    places,
    speaking,
)


def _mutants(module: ModuleType) -> Iterator[Mutant]:
    return (found for found in vars(module).values() if isinstance(found, Mutant))


def _by_name() -> Mapping[str, Mutant]:
    found: dict[str, Mutant] = {}
    modules = (each for module in _MODULES for each in _mutants(module))
    for each in (*ACCEPTING, *BUT_FOR_SOME, *SILENT, *OWN, *ALONE, *modules):
        if each.name in found:
            raise ValueError(f"there are two mutants '{each.name}'")
        found[each.name] = each
    return MappingProxyType(found)


MUTANTS = _by_name()
