// Whether a name is near a known name: the definition of "near" in the chapter on scope and terms.

const lower = (name) => [...name].map((each) => (each >= "A" && each <= "Z" ? each.toLowerCase() : each));

/** Whether `name`, which is not `known`, is near it. */
export function isNear(name, known) {
  const most = [...known].length < 5 ? 1 : 2;
  const a = lower(name);
  const b = lower(known);
  return Math.abs(a.length - b.length) <= most && edits(a, b) <= most;
}

function edits(a, b) {
  const d = [];
  for (let i = 0; i <= a.length; i += 1) {
    d.push([]);
    for (let j = 0; j <= b.length; j += 1) {
      if (i === 0 || j === 0) {
        d[i].push(i + j);
        continue;
      }
      let least = Math.min(d[i - 1][j], d[i][j - 1]) + 1;
      if (a[i - 1] === b[j - 1]) least = Math.min(least, d[i - 1][j - 1]);
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1])
        least = Math.min(least, d[i - 2][j - 2] + 1);
      d[i].push(least);
    }
  }
  return d[a.length][b.length];
}
