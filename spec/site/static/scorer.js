// The order of the results of the search: Sphinx makes this file a part of its searchtools.js.
//
// A search most often names a concept. A page or section with that name comes first, then a function or class, then the pages
// that mention it. A page of a diagnostic comes before these only if it is asked for by its code. Attributes of classes and
// properties of schemas come last: many have the same name.

const wordsOf = (text) => (text.toLowerCase().match(/[\p{Letter}\p{Number}]+/gu) ?? []).map((word) => word.replace(/s$/, ""));

// How much of a name is asked for, from 0 to 1; 0 if the name lacks a word that is asked for.
const askedOf = (name) => {
  const asked = wordsOf(new URLSearchParams(location.search).get("q") ?? "");
  const words = wordsOf(name);
  return asked.every((word) => words.includes(word)) ? Math.min(1, asked.length / words.length) : 0;
};

var Scorer = {
  score: ([page, title, , about, score, , kind]) => {
    if (kind === "index") return score === 100 ? score : 0.4 * score;
    if (kind === "object") {
      if (/^(Python (attribute|property)|Extended URDF property),/.test(about)) return score - 20;
      return askedOf(title.split(".").pop()) === 1 ? 26 : score;
    }
    if (page.startsWith("diagnostics/")) return askedOf(title) === 1 ? 36 : 0;
    const section = title.split(" > ")[1];
    return score + (section === undefined ? 20 * askedOf(title) : 10 * askedOf(section));
  },

  // The values of Sphinx.
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
