// The lines of a text around a place.

const AROUND = 1; // lines before and after
const WIDEST = 160; // characters of a line that are shown

/** What a diagnostic points at: a tag, a quoted text, a number or a word. */
const TOKEN = /^(<[/?!]?[^\s<>/]+|"[^"\n]*"|'[^'\n]*'|[^\s,\]}"'<>]+|.)/u;

/**
 * @param text The text of a file; undefined if there is none.
 * @param line From 1, or null for the file as a whole.
 * @param column From 1, in characters (code points).
 * @returns [{number, text, mark: [begin, end] | null}], where `mark` is what is at the column.
 */
export function linesAt(text, line, column) {
  if (text === undefined || line === null) return [];
  const all = text.split(/\r\n|\r|\n/);
  const from = Math.max(1, line - AROUND);
  return all.slice(from - 1, line + AROUND).map((whole, index) => {
    const number = from + index;
    if (number !== line) return { number, text: cut(whole, 0).text, mark: null };
    const begin = [...whole].slice(0, column - 1).join("").length;
    const { text: shown, offset } = cut(whole, begin);
    const token = TOKEN.exec(shown.slice(begin - offset))?.[0] ?? "";
    return { number, text: shown, mark: [begin - offset, begin - offset + token.length] };
  });
}

/** The part of a line around a place, and where it begins. */
function cut(line, at) {
  const offset = at > WIDEST / 2 && line.length > WIDEST ? at - WIDEST / 2 : 0;
  return { text: line.slice(offset, offset + WIDEST), offset };
}
