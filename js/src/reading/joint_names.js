// What the names of joints refer to, in the mechanism that the description makes.

export class JointNames {
  /** `byName`: the joints of the model; `joints`: those of the URDF; `merges`: by the last joint of each. */
  constructor(byName, joints, changes, merges) {
    this.byName = byName;
    this.merged = new Set([...merges.values()].flatMap((merge) => merge.joints.map(({ name }) => name)));
    const faulty = changes.filter(({ isFaulty, isUnknown }) => isFaulty && !isUnknown);
    this.unclear = new Set(faulty.flatMap(({ joint, merges: names = [] }) => [joint, ...names]));
    this.known = new Set([...joints.keys(), ...byName.keys()]);
  }

  has(name) {
    return this.known.has(name);
  }

  names() {
    return this.known;
  }

  /** A joint of the model; {isMerged} for one that became part of another; undefined if there is none. */
  find(name) {
    return this.byName.get(name) ?? (this.merged.has(name) ? { isMerged: true } : undefined);
  }

  /** Whether an error of its own leaves open what a joint is. */
  isUnclear(name) {
    return this.unclear.has(name) || Boolean(this.byName.get(name)?.isFaulty);
  }

  moving() {
    return [...this.byName.values()].filter(({ type }) => type !== "fixed");
  }
}
