// A configuration written into descriptions of unusual forms.

import assert from "node:assert/strict";
import test from "node:test";
import { parse } from "yaml";
import { withConfiguration } from "../page/drop/configuration_text.js";

const Q = { motor: [0.5], ball: [0, 0, 0.6, 0.8], free: [0], "a, b": [1e-7] };
const NEUTRAL = { motor: [0], ball: [0, 0, 0, 1], free: [0], "a, b": [0] };
const STATED = { motor: 0.5, ball: [0, 0, 0.6, 0.8], "a, b": 1e-7 };

const FORMS = {
  "without configurations": "name: r # what\n",
  "without a line break at the end": "name: r",
  "in braces": "{name: r, configurations: {rest: {motor: 1}}}\n",
  "with an empty mapping": "configurations: {}\nname: r\n",
  "with an empty value": "configurations:\nname: r\n",
  "with another configuration": "configurations:\n  rest: {motor: 1}   # here\nname: r\n",
  "with an alias": "x-a: &a {motor: 1}\nconfigurations: {assembled: *a}\n",
  "on several lines":
    "configurations:\n  assembled:\n    motor: 1 # first\n    # second\n    ball: [0, 0,\n      0, 1]\n# end\nname: r\n",
};

for (const [form, text] of Object.entries(FORMS)) {
  test(`a description ${form} gets the configuration`, () => {
    const before = parse(text);
    const written = withConfiguration(text, "assembled", Q, NEUTRAL);
    assert.deepEqual(parse(written), { ...before, configurations: { ...before.configurations, assembled: STATED } });
    for (const [comment] of text.matchAll(/#.*/g)) assert.ok(written.includes(comment), written);
  });
}

test("a joint that is stated stays stated where it is neutral", () => {
  const written = withConfiguration("configurations: {assembled: {free: 1}}\n", "assembled", Q, NEUTRAL);
  assert.deepEqual(parse(written).configurations.assembled, { ...STATED, free: 0 });
});

test("other lines stay as they are", () => {
  const text = "gears:   [1.0e-3,  6.1e-05]   # as  measured\nconfigurations:\n  assembled: {}\n";
  assert.ok(
    withConfiguration(text, "assembled", Q, NEUTRAL).startsWith("gears:   [1.0e-3,  6.1e-05]   # as  measured\n"),
  );
});
