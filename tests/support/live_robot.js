// Moves robots as a live page does: reads [{robot, moves: [[slider, value], …]}, …], and writes for each robot what is
// there at first and after each move.
const live = require("path").resolve(process.argv[2]);
for (const name of ["linear_algebra", "mechanism", "springs", "motion"]) require(`${live}/${name}.js`);

function state(motion, stop) {
  const { mechanism, q } = motion;
  const placed = mechanism.place(q);
  return {
    stop,
    q,
    largest: motion.residual,
    residual: mechanism.constraints.flatMap((each) => mechanism.residual(each, q, placed)),
    // Of each constraint, its rows by the index of each velocity.
    jacobian: mechanism.constraints.map((each) => [...mechanism.derivative(each, placed)]),
    poses: placed.bodies.map(({ R, p }) => [...R, ...p]),
  };
}

const cases = JSON.parse(require("fs").readFileSync(0, "utf-8"));
const answers = cases.map(({ robot, moves }) => {
  const motion = new globalThis.eurdf.Motion(robot);
  return [state(motion, null), ...moves.map(([slider, value]) => state(motion, motion.move(slider, value)))];
});
process.stdout.write(JSON.stringify(answers));
