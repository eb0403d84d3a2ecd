// Namespaces in XML 1.0, EU-URD-001. The package `saxes` has an option for them, but removes white space around a
// namespace.

const XML = "http://www.w3.org/XML/1998/namespace";
const XMLNS = "http://www.w3.org/2000/xmlns/";

// Of a name of XML: with one colon at most, followed by a character that can begin a name.
const NAME = /^[^:]+(:[^:\-.0-9\u00B7\u0300-\u036F\u203F\u2040][^:]*)?$/;

/** Namespaces around the root element: those declared in an element, by prefix, and those around it. */
export const OUTERMOST = { declared: new Map([["xml", XML]]), around: null };

/** The namespaces in an element, from those around it; calls `fail` with what is wrong. */
export function namespacesIn({ name, attributes }, around, fail) {
  if (!attributes.size && !name.includes(":")) return around;
  if (!attributes.size && !name.includes(":")) return around; // as in most of a million elements
  for (const each of [name, ...attributes.keys()]) {
    if (!NAME.test(each)) fail(`the colon in the name ${each} is not allowed there`);
  }
  const stated = [...attributes].filter(([key]) => /^xmlns(:|$)/.test(key));
  const namespaces = stated.length ? { declared: new Map(), around } : around;
  for (const [key, namespace] of stated) {
    const prefix = key.slice("xmlns:".length);
    const isReserved = prefix === "xmlns" || namespace === XMLNS || (prefix === "xml") !== (namespace === XML);
    if (isReserved || (prefix && !namespace)) fail(`${key}="${namespace}" is not allowed`);
    namespaces.declared.set(prefix, namespace);
  }
  const namespaceOf = (each) => {
    const prefix = each.includes(":") ? each.slice(0, each.indexOf(":")) : "";
    let at = namespaces;
    while (at && !at.declared.has(prefix)) at = at.around;
    if (prefix && !at) fail(`the prefix of ${each} is not declared`);
    return at?.declared.get(prefix);
  };
  namespaceOf(name);
  const seen = new Set();
  for (const key of attributes.keys()) {
    if (!key.includes(":") || key.startsWith("xmlns:")) continue;
    const expanded = `${namespaceOf(key)} ${key.slice(key.indexOf(":"))}`;
    if (seen.has(expanded)) fail(`${key} of <${name}> has the name and namespace of another attribute`);
    seen.add(expanded);
  }
  return namespaces;
}
