// Namespaces in XML 1.0, EU-URD-001. The package `saxes` has an option for them, but removes white space around a namespace.

import { fail } from "./invalid.js";

const XML = "http://www.w3.org/XML/1998/namespace";
const XMLNS = "http://www.w3.org/2000/xmlns/";

// Of a name of XML: with one colon at most, followed by a character that can begin a name.
const NAME = /^[^:]+(:[^:\-.0-9\u00B7\u0300-\u036F\u203F\u2040][^:]*)?$/;

/** Namespaces by prefix around the root element. */
export const OUTERMOST = new Map([["xml", XML]]);

/** The namespaces by prefix in an element, from those around it. */
export function namespacesIn({ name, attributes }, around) {
  for (const each of [name, ...attributes.keys()]) {
    if (!NAME.test(each)) fail(`urdf: the colon in the name ${each} is not allowed there`);
  }
  const declared = [...attributes].filter(([key]) => /^xmlns(:|$)/.test(key));
  const namespaces = declared.length ? new Map(around) : around;
  for (const [key, namespace] of declared) {
    const prefix = key.slice("xmlns:".length);
    const isReserved = prefix === "xmlns" || namespace === XMLNS || (prefix === "xml") !== (namespace === XML);
    if (isReserved || (prefix && !namespace)) fail(`urdf: ${key}="${namespace}" is not allowed`);
    namespaces.set(prefix, namespace);
  }
  namespaceOf(name, namespaces);
  const seen = new Set();
  for (const key of attributes.keys()) {
    if (!key.includes(":") || key.startsWith("xmlns:")) continue;
    const expanded = `${namespaceOf(key, namespaces)} ${key.slice(key.indexOf(":"))}`;
    if (seen.has(expanded)) fail(`urdf: ${key} of <${name}> has the name and namespace of another attribute`);
    seen.add(expanded);
  }
  return namespaces;
}

function namespaceOf(name, namespaces) {
  const prefix = name.includes(":") ? name.slice(0, name.indexOf(":")) : "";
  if (prefix && !namespaces.has(prefix)) fail(`urdf: the prefix of ${name} is not declared`);
  return namespaces.get(prefix);
}
