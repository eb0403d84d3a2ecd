// What the page says of a robot at a configuration.

const NAMED = 3; // open loops that are named

const rounded = (value) => String(Number(value.toPrecision(4)));

/** A coordinate with its unit; an angle in degrees or rad. */
export function quantity(value, unit, degrees) {
  const inDegrees = unit === "rad" && degrees;
  const [number, digits, symbol] = inDegrees ? [(value * 180) / Math.PI, 1, "°"] : [value, 3, ` ${unit}`];
  return `${number.toFixed(digits).replace(/^-(0\.0+)$/, "$1")}${symbol}`;
}

/** Why a motion stopped before its goal. `unit`: of the joint, if it has one coordinate. */
export function whyStopped({ reason, joint, value, error }, unit, degrees) {
  const at = () => (unit ? quantity(value, unit, degrees) : rounded(value));
  switch (reason) {
    case "limit":
      return `“${joint}” is at its position limit ${at()}.`;
    case "passive limit":
      return `Passive joint “${joint}” is at its position limit ${at()}.`;
    case "half turn":
      return `“${joint}” is half a turn from its neutral configuration.`;
    case "dead point":
      return `Dead point: at ${at()}, “${joint}” no longer determines the passive joints.`;
    case "blocked":
      return `The loops block “${joint}”: it cannot move with the other actuators held.`;
    case "held at limit":
      return `“${joint}” is at its position limit: the part stays ${rounded(1000 * error)} mm behind the pointer.`;
    default: // out of reach
      return `The part cannot reach the pointer: it stays ${rounded(1000 * error)} mm behind.`;
  }
}

/** Whether the loops are closed. */
export function stateOfLoops({ robot, residual, residuals, isClosed }) {
  if (!Object.keys(residuals).length) return `“${robot.name}” has no loops.`;
  if (isClosed) return `The loops are closed: residual ${residual.toExponential(1)}.`;
  const open = Object.keys(residuals).filter((name) => residuals[name].some((row) => Math.abs(row) > 1e-6));
  const names = open.slice(0, NAMED).map((name) => `“${name}”`);
  if (open.length > NAMED) names.push(`${open.length - NAMED} more`);
  return `The loops are open at ${names.join(", ")}: residual ${residual.toExponential(1)}.`;
}
