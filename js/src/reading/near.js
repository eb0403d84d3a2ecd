// Whether a name is near a known name: the definition of "near" in the chapter on scope and terms.

const lower = (name) => [...name].map((each) => (each >= "A" && each <= "Z" ? each.toLowerCase() : each));

/** How many characters a name has. */
function lengthOf(name) {
  let length = name.length;
  for (let i = 1; i < name.length; i += 1) if (name.codePointAt(i - 1) > 0xffff) length -= 1;
  return length;
}

/** Whether `name`, which is not `known`, is near it. */
export function isNear(name, known) {
  const length = lengthOf(known);
  const most = length < 5 ? 1 : 2;
  if (name.length > 2 * (length + most)) return false; // a name may have megabytes
  return Math.abs(lengthOf(name) - length) <= most && edits(lower(name), lower(known)) <= most;
}

/** A hint with the first known name that `name` is near. */
export function meant(name, known) {
  return () => {
    const right = [...known].find((each) => isNear(name, each));
    return right === undefined ? null : `did you mean '${right}'?`;
  };
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
