// Uses every export of the package; compiled, and not run.

import URDFLoader from "urdf-loader";
import { Object3D, Scene } from "three";
import { closuresOfDialects, read, urdfOf, type Configuration, type Diagnostic, type Robot } from "extended-urdf";
import { Kinematics, Mechanism } from "extended-urdf/mechanism";
import { Drive, analyze, assemble, drag, limits, openLoops, sliders, sweep, type Stop } from "extended-urdf/closing";
import { InvalidRobot, closedChainIK, loadExtendedURDF, loadMesh, shapesOf, withClosedLoops } from "extended-urdf/three";
import * as ik from "closed-chain-ik/src/core/index.js";

const files = { description: { name: "robot.yaml", text: "" }, urdf: { name: "robot.urdf", text: new Uint8Array() } };
const found: { robot: Robot | null; diagnostics: Diagnostic[] } = read({ ...files, files: (name) => name.endsWith(".stl") });
const robot = found.robot!;
const names: string[] = [urdfOf(files.description), ...closuresOfDialects("<robot/>").losses];

const mechanism = new Mechanism(robot);
const q: Configuration = mechanism.named("assembled") ?? mechanism.neutral();
const kinematics: Kinematics = mechanism.at(mechanism.integrate(q, new Float64Array(mechanism.nv)));
const z: number = kinematics.pose(robot.closures[0].frames[0]).p[2] + kinematics.pose(robot.rootLink).R[2][2];
const rows: number[][] = kinematics.jacobian().rows.pin;
const masses: number[] = [kinematics.mass(), ...kinematics.massMatrix().matrix[0], ...(kinematics.centerOfMass() ?? [])];
const residual: number[] = kinematics.residuals().pin;

const { closes, open } = assemble(mechanism, q, { limits: true });
const still: number[] = openLoops(mechanism, q).map(({ angle }) => angle);
const drive = new Drive(mechanism, q);
const stop: Stop | null = drive.move("motor", 0, drive.value("motor") + 0.1).stop;
const { error, atLimits } = drag(mechanism, drive.q, { link: "foot", point: [0, 0, 0], target: [0, 0, 1] });
const ends: string[] = [sweep(mechanism, q, "motor", { steps: 20 }).lower.end, ...sliders(mechanism, q).map(({ label }) => label)];
const room: number[] = limits(mechanism, q).map(({ distance }) => distance);
const mobility: number = analyze(mechanism, q).mobility;

const loaded = await loadExtendedURDF("robot.yaml", { loader: new URDFLoader() }).catch((reason: InvalidRobot) => {
  throw reason.diagnostics[0];
});
new Scene().add(loaded, withClosedLoops(new URDFLoader().parse(""), robot));
const moved: boolean = loaded.setJointValue("motor", 0.1);
const shown: Object3D = shapesOf([...robot.links.values()][0], { mesh: async () => new ArrayBuffer(0) }).object;
shown.add(await loadMesh("a.stl", new ArrayBuffer(0)), ...loaded.closures[0].frames);
const { root, losses, configuration } = closedChainIK(loaded, ik);
new ik.Solver(root).solve();
loaded.q = configuration();
console.log(names, z, rows, masses, residual, closes, open, still, stop, error, atLimits, ends, room, mobility, moved, losses, loaded.stop);
