// The diagnostics of a robot as a list, each with its place, its lines and its hint.

import { element } from "../elements.js";

const MOST = 200; // more are only counted

/**
 * @param list An element, which is filled.
 * @param diagnostics As `read` returns them, with `lines`: [{number, text, mark: [begin, end] | null}].
 * @param fix Called with a diagnostic that has a `fix` if a person wants it.
 */
export function showDiagnostics(list, diagnostics, fix) {
  list.replaceChildren();
  for (const each of diagnostics.slice(0, MOST))
    showDiagnostic(element(list, "li", { class: `drop-${each.severity}` }), each, fix);
  const more = diagnostics.length - MOST;
  if (more > 0) element(list, "li", {}, `and ${more} more`);
}

function showDiagnostic(item, { code, severity, file, line, column, message, hint, lines, fix: own }, fix) {
  const head = element(item, "p", { class: "drop-place" });
  element(head, "span", { class: "drop-severity" }, severity);
  const at = line === null ? file : `${file}:${line}:${column}`;
  element(head, "span", { class: "drop-at" }, at);
  const page = { href: `diagnostics/${encodeURIComponent(code)}.html`, target: "_blank", rel: "noopener" };
  element(head, "a", page, code);
  element(item, "p", { class: "drop-message" }, message);
  if (lines.length) showLines(element(item, "pre", { tabindex: "0", "aria-label": `Lines of ${file}` }), lines);
  if (hint) element(item, "p", { class: "drop-hint" }, hint);
  if (own) element(item, "button", { type: "button" }, `Fix: ${own.summary}`).addEventListener("click", () => fix(own));
}

function showLines(pre, lines) {
  for (const { number, text, mark } of lines) {
    const row = element(pre, "span", { class: "drop-line" });
    element(row, "span", { class: "drop-number" }, String(number));
    const [begin, end] = mark ?? [text.length, text.length];
    row.append(text.slice(0, begin));
    if (mark) element(row, "mark", {}, text.slice(begin, end));
    row.append(text.slice(end), "\n");
  }
}
