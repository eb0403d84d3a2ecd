// The parser behind the protocol: one request a line on standard input, one answer a line on standard output.
// --parser="cmd:node main.js"

import { answer } from "./answers.js";
import { textsAt } from "./files.js";

/** Lines end at a line feed alone, whatever other separators a name contains. */
async function* lines(stream) {
  stream.setEncoding("utf8");
  let pieces = [];
  for await (const chunk of stream) {
    const [first, ...others] = chunk.split("\n");
    pieces.push(first);
    for (const other of others) {
      yield pieces.join("");
      pieces = [other];
    }
  }
}

for await (const line of lines(process.stdin)) {
  const request = JSON.parse(line);
  process.stdout.write(`${answer(request, textsAt)}\n`);
  if (request.command === "stop") break;
}
