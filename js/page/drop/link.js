// A robot in the part of an address behind "#": its two texts as JSON, compressed (raw deflate), in base64url.
// A browser sends this part to no server. Meshes are not in it.

const KEY = "#robot=";
const MOST_CHARACTERS = 200_000; // what a browser keeps of an address; many programs keep less
const MOST_BYTES = 40_000_000; // of the JSON: more than two files within their bounds

/**
 * The part behind the address; throws `Error` if it is too long.
 *
 * @param texts {description, urdf, q}: two {name, text}, the description may be null; a configuration, or undefined.
 */
export async function encodeLink(texts) {
  const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(JSON.stringify(texts)));
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  const link = KEY + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  if (link.length > MOST_CHARACTERS) {
    throw new Error(
      `the link would have ${link.length} characters; browsers keep ${MOST_CHARACTERS}: send the files instead`,
    );
  }
  return link;
}

/** What `encodeLink` was given; null if the part is no such link; throws `Error` if it is damaged. */
export async function decodeLink(hash) {
  if (!hash.startsWith(KEY)) return null;
  try {
    const binary = atob(hash.slice(KEY.length).replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(binary, (character) => character.charCodeAt(0));
    const texts = JSON.parse(new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes)));
    if (!isText(texts.urdf) || !(texts.description === null || isText(texts.description)))
      throw new Error("it holds no robot");
    return texts;
  } catch (error) {
    throw new Error(`the link is damaged (${error.message}); ask for it again, or for the files`);
  }
}

const isText = (file) => typeof file?.name === "string" && typeof file.text === "string";

async function through(transform, bytes) {
  const reader = new Blob([bytes]).stream().pipeThrough(transform).getReader();
  const pieces = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > MOST_BYTES) {
      reader.cancel();
      throw new Error(`it holds more than ${MOST_BYTES} bytes`);
    }
    pieces.push(value);
  }
  return new Uint8Array(await new Blob(pieces).arrayBuffer());
}
