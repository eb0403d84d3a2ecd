// Elements of a page. Text is never markup.

/** Append an element with attributes and text to `parent`. */
export function element(parent, tag, attributes = {}, text = "") {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  parent.append(made);
  return made;
}

/** Append a button that does something. */
export function button(parent, text, done, attributes = {}) {
  const made = element(parent, "button", { type: "button", ...attributes }, text);
  made.addEventListener("click", () => done(made));
  return made;
}
