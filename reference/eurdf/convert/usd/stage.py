"""A stage of USD while it is written: the prims that a robot needs, and the content of the files.

Facts that it relies on (the UsdPhysics schema of OpenUSD 26): lengths are in metersPerUnit, angles in degrees; the
frames of joints, masses, limits and gains are in single precision; a joint is free along every axis that it does not
limit, and locked where the lower limit is above the upper one.
"""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade

from eurdf.array import Matrix
from eurdf.convert.export_format import Triangles
from eurdf.convert.usd.joints import turns
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion, Vector3

#: m/s² along -z.
GRAVITY = 9.81

_D6_AXES = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")

_JOINTS = {
    "fixed": UsdPhysics.FixedJoint,
    "revolute": UsdPhysics.RevoluteJoint,
    "prismatic": UsdPhysics.PrismaticJoint,
    "spherical": UsdPhysics.SphericalJoint,
    "distance": UsdPhysics.DistanceJoint,
    "d6": UsdPhysics.Joint,
}


class UsdStage:
    """A robot in USD: bodies beside each other, joints, closures and materials, in a scope each."""

    def __init__(self, robot: str, shown: str) -> None:
        # Payloads are files that do not exist yet.
        self._stage = Usd.Stage.CreateInMemory("robot.usda", Usd.Stage.LoadNone)
        UsdGeom.SetStageUpAxis(self._stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(self._stage, 1.0)
        UsdPhysics.SetStageKilogramsPerUnit(self._stage, 1.0)
        self.robot = f"/{robot}"
        prim = UsdGeom.Xform.Define(self._stage, self.robot).GetPrim()
        self._stage.SetDefaultPrim(prim)
        Usd.ModelAPI(prim).SetKind("component")
        _show(prim, shown)
        self._materials: dict[tuple[float, ...], str] = {}
        # Beside the robot: who refers to the robot in a scene of their own keeps their gravity.
        scene = UsdPhysics.Scene.Define(self._stage, "/physics_scene")
        scene.CreateGravityDirectionAttr(Gf.Vec3f(0.0, 0.0, -1.0))
        scene.CreateGravityMagnitudeAttr(GRAVITY)

    # -- bodies -----------------------------------------------------------------------------------------------------

    def frame(self, parent: str, name: str, pose: Pose, shown: str = "") -> str:
        """Add a frame at a pose in a prim; returns its path."""
        path = f"{parent}/{name}"
        prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
        _place(prim, pose)
        _show(prim, shown)
        return path

    def body(self, name: str, pose: Pose, shown: str = "") -> str:
        """Add a rigid body at a pose in the robot; returns its path."""
        path = self.frame(self._scope("bodies"), name, pose, shown)
        UsdPhysics.RigidBodyAPI.Apply(self._prim(path))
        return path

    def mass(self, body: str, mass: float, centre: Vector3, moments: Matrix) -> None:
        """State mass (kg), centre (m) and rotational inertia about it (3, 3) (kg·m²) of a body, in its frame."""
        principal, axes = np.linalg.eigh(moments)
        if np.linalg.det(axes) < 0.0:
            axes[:, 0] = -axes[:, 0]
        api = UsdPhysics.MassAPI.Apply(self._prim(body))
        api.CreateMassAttr(mass)
        api.CreateCenterOfMassAttr(Gf.Vec3f(*centre))
        single = principal.astype(np.float32).astype(np.float64)
        # Readers check that no moment exceeds the sum of the others: rounding keeps it so.
        most = single[0] + single[1]
        if single[2] > most:
            single[2] = (
                np.float32(most) if np.float32(most) <= most else np.nextafter(np.float32(most), np.float32(0.0))
            )
        api.CreateDiagonalInertiaAttr(Gf.Vec3f(*single.tolist()))
        rotation = Gf.Matrix3d(*axes.T.flatten().tolist()).ExtractRotation().GetQuat()  # Gf multiplies rows
        api.CreatePrincipalAxesAttr(Gf.Quatf(rotation))

    def articulation_root(self, path: str) -> None:
        """Let simulators that have reduced coordinates start the tree at a prim."""
        UsdPhysics.ArticulationRootAPI.Apply(self._prim(path))

    def no_contact(self, body: str, others: Iterable[str]) -> None:
        """Let a body not collide with others."""
        UsdPhysics.FilteredPairsAPI.Apply(self._prim(body)).CreateFilteredPairsRel().SetTargets(list(others))

    # -- joints -----------------------------------------------------------------------------------------------------

    def joint(
        self,
        scope: str,
        name: str,
        kind: str,
        ends: Sequence[tuple[str, Pose]],
        *,
        axis: str = "",
        closes: bool = False,
        shown: str = "",
    ) -> str:
        """Add a joint.

        Args:
            scope: Scope that it is in.
            name: Its name there.
            kind: ``fixed``, ``revolute``, ``prismatic``, ``spherical``, ``distance`` or ``d6``.
            ends: Path of each of the two prims that it joins, and its frame there.
            axis: Of a revolute or prismatic joint: ``X``, ``Y`` or ``Z`` of the frames.
            closes: Whether it closes a loop: it is excluded from the articulation.
            shown: The name to show.

        Returns:
            Its path.
        """
        path = f"{self._scope(scope)}/{name}"
        joint = _JOINTS[kind].Define(self._stage, path)
        for index, (body, pose) in enumerate(ends):
            getattr(joint, f"CreateBody{index}Rel")().SetTargets([body])
            getattr(joint, f"CreateLocalPos{index}Attr")(Gf.Vec3f(*pose.xyz))
            getattr(joint, f"CreateLocalRot{index}Attr")(Gf.Quatf(_quaternion(pose.quaternion)))
        if axis:
            joint.CreateAxisAttr(axis)
        if closes:
            joint.CreateExcludeFromArticulationAttr(True)
        _show(joint.GetPrim(), shown)
        return path

    def distance(self, joint: str, length: float) -> None:
        """State the distance of the two frames of a distance joint, m."""
        found = UsdPhysics.DistanceJoint(self._prim(joint))
        found.CreateMinDistanceAttr(length)
        found.CreateMaxDistanceAttr(length)

    def limits(self, joint: str, axis: str, lower: float, upper: float) -> None:
        """State the position limits (rad or m; infinite for none) of an axis of a joint."""
        scale = _scale(axis)
        if axis in _D6_AXES:  # stated even if it is free: some programs know only the axes with a limit
            limit = UsdPhysics.LimitAPI.Apply(self._prim(joint), axis)
            limit.CreateLowAttr(lower * scale)
            limit.CreateHighAttr(upper * scale)
            return
        found = (UsdPhysics.RevoluteJoint if turns(axis) else UsdPhysics.PrismaticJoint)(self._prim(joint))
        if math.isfinite(lower):
            found.CreateLowerLimitAttr(lower * scale)
        if math.isfinite(upper):
            found.CreateUpperLimitAttr(upper * scale)

    def lock_others(self, joint: str, free: Iterable[str]) -> None:
        """Lock the axes of a general joint that are not free."""
        for axis in _D6_AXES:
            if axis not in free:
                limit = UsdPhysics.LimitAPI.Apply(self._prim(joint), axis)
                limit.CreateLowAttr(1.0)
                limit.CreateHighAttr(-1.0)

    def drive(self, joint: str, axis: str, stiffness: float, damping: float, target: float, most: float) -> None:
        """Add a drive: force = stiffness (target - position) - damping velocity, of at most ``most``; SI units."""
        scale = _scale(axis)
        drive = UsdPhysics.DriveAPI.Apply(self._prim(joint), axis)
        drive.CreateTypeAttr("force")
        drive.CreateStiffnessAttr(stiffness / scale)
        drive.CreateDampingAttr(damping / scale)
        drive.CreateTargetPositionAttr(target * scale)
        if math.isfinite(most):
            drive.CreateMaxForceAttr(most)

    def state(self, joint: str, axis: str, position: float) -> None:
        """State the coordinate (rad or m) of an axis of a joint where the bodies are."""
        prim = self._prim(joint)
        prim.AddAppliedSchema(f"PhysicsJointStateAPI:{axis}")
        self._number(prim, f"state:{axis}:physics:position", position * _scale(axis))

    def numbers_of_simulators(self, joint: str, schema: str, values: Mapping[str, float]) -> None:
        """State numbers of a joint in the schema of a simulator, which this installation of USD may not know."""
        prim = self._prim(joint)
        prim.AddAppliedSchema(schema)
        for name, value in values.items():
            self._number(prim, name, value)

    def mimic(self, joint: str, leader: str, multiplier: float, offset: float) -> None:
        """Let a joint follow another one, in the schema of Newton; the offset is in degrees for a rotation."""
        names = {"newton:mimicCoef0": offset, "newton:mimicCoef1": multiplier}
        self.numbers_of_simulators(joint, "NewtonMimicAPI", names)
        self._prim(joint).CreateRelationship("newton:mimicJoint", custom=False).SetTargets([leader])

    # -- shapes -----------------------------------------------------------------------------------------------------

    def shape(self, parent: str, name: str, kind: str, size: Sequence[float], pose: Pose) -> str:
        """Add a box, cylinder, sphere or capsule, of a size as in `eurdf.mechanism.body.Shape`; returns its path."""
        path = f"{parent}/{name}"
        match kind:
            case "box":
                UsdGeom.Cube.Define(self._stage, path).CreateSizeAttr(1.0)
            case "sphere":
                UsdGeom.Sphere.Define(self._stage, path).CreateRadiusAttr(size[0])
            case _:
                shape = (UsdGeom.Cylinder if kind == "cylinder" else UsdGeom.Capsule).Define(self._stage, path)
                shape.CreateAxisAttr("Z")
                shape.CreateRadiusAttr(size[0])
                shape.CreateHeightAttr(size[1])
        _place(self._prim(path), pose, size if kind == "box" else None)
        return path

    def mesh(self, parent: str, name: str, file: str, scale: Sequence[float], pose: Pose) -> str:
        """Add a mesh of a file with one; returns its path."""
        path = f"{parent}/{name}"
        prim = UsdGeom.Mesh.Define(self._stage, path).GetPrim()
        prim.GetPayloads().AddPayload(f"./{file}")
        _place(prim, pose, scale)
        return path

    def collides(self, shape: str) -> None:
        """Let a shape collide; it is not rendered."""
        prim = self._prim(shape)
        UsdPhysics.CollisionAPI.Apply(prim)
        if prim.IsA(UsdGeom.Mesh):
            UsdPhysics.MeshCollisionAPI.Apply(prim).CreateApproximationAttr("convexHull")
        UsdGeom.Imageable(prim).CreatePurposeAttr(UsdGeom.Tokens.guide)

    def color(self, shape: str, color: Sequence[float]) -> None:
        """Give a shape a material of a color: red, green, blue, alpha from 0 to 1, as a display shows them (sRGB)."""
        key = tuple(color)
        if key not in self._materials:
            self._materials[key] = path = f"{self._scope('materials')}/color_{len(self._materials) + 1}"
            material = UsdShade.Material.Define(self._stage, path)
            shader = UsdShade.Shader.Define(self._stage, f"{path}/surface")
            shader.CreateIdAttr("UsdPreviewSurface")
            linear = Gf.Vec3f(*(_linear(value) for value in key[:3]))
            shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(linear)
            shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(key[3])
            material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        material = UsdShade.Material.Get(self._stage, self._materials[key])
        UsdShade.MaterialBindingAPI.Apply(self._prim(shape)).Bind(material)

    # -- files ------------------------------------------------------------------------------------------------------

    def content(self) -> bytes:
        """The main file, as text; every number is read back to the last bit of its type."""
        return str(self._stage.GetRootLayer().ExportToString()).encode()

    def _prim(self, path: str) -> Usd.Prim:
        return self._stage.GetPrimAtPath(path)

    def _scope(self, name: str) -> str:
        path = f"{self.robot}/{name}"
        UsdGeom.Scope.Define(self._stage, path)
        return path

    @staticmethod
    def _number(prim: Usd.Prim, name: str, value: float) -> None:
        prim.CreateAttribute(name, Sdf.ValueTypeNames.Float, custom=False).Set(value)


def mesh_file(triangles: Triangles) -> bytes:
    """The content of a file with one mesh."""
    stage = Usd.Stage.CreateInMemory("mesh.usdc")
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    mesh = UsdGeom.Mesh.Define(stage, "/mesh")
    stage.SetDefaultPrim(mesh.GetPrim())
    vertices, faces = triangles
    points = vertices.astype(np.float32)
    mesh.CreatePointsAttr(points)
    mesh.CreateFaceVertexCountsAttr(np.full(len(faces), 3, np.int32))
    mesh.CreateFaceVertexIndicesAttr(faces.astype(np.int32).ravel())
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateExtentAttr(np.array((points.min(axis=0), points.max(axis=0))))
    with tempfile.TemporaryDirectory(prefix="eurdf-") as folder:
        path = os.path.join(folder, "mesh.usdc")
        stage.GetRootLayer().Export(path)
        with open(path, "rb") as file:
            return file.read()


def _place(prim: Usd.Prim, pose: Pose, scale: Sequence[float] | None = None) -> None:
    at = UsdGeom.Xformable(prim)
    if pose != IDENTITY or scale is not None:
        at.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*pose.xyz))
        at.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(_quaternion(pose.quaternion))
    if scale is not None:
        at.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*scale))


def _show(prim: Usd.Prim, name: str) -> None:
    """Keep a name that a prim cannot have."""
    if name and name != prim.GetName():
        prim.SetDisplayName(name)


def _quaternion(quaternion: Quaternion) -> Gf.Quatd:
    x, y, z, w = quaternion
    return Gf.Quatd(w, x, y, z)


def _scale(axis: str) -> float:
    return 180.0 / math.pi if turns(axis) else 1.0


def _linear(value: float) -> float:
    """Of a component in sRGB, the linear one (IEC 61966-2-1)."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
