// What the server computes of a robot: dimensions, distance to singularity, diagnostics, limits of passive joints, graph.

import { element } from "./elements.js";

const rounded = (value) => String(Number(value.toPrecision(4)));

/** The tab of the robot: dimensions, distance to singularity, diagnostics. */
export class RobotTab {
  constructor(parent, facts) {
    parent.replaceChildren();
    this.farthest = 0; // the largest distance to singularity met
    this.gauge = element(parent, "p");
    this.meter = element(parent, "meter", { min: 0, max: 1, "aria-label": "Distance to singularity" });
    const body = element(element(parent, "table", { class: "eu-facts" }), "tbody");
    for (const [name, value, meaning] of facts.dimensions) {
      const row = element(body, "tr");
      element(row, "th", { scope: "row" }, name);
      element(row, "td", {}, value ?? "-");
      element(row, "td", { class: "eu-meaning" }, meaning);
    }
    for (const names of facts.dependent) element(parent, "p", { class: "eu-warning" }, `Dependent actuators: ${names.join(", ")}`);
    if (facts.note) element(parent, "p", { class: "eu-warning" }, facts.note);
    this.list = element(parent, "ul", { class: "eu-diagnostics", "aria-label": "Diagnostics" });
    this.report(facts.diagnostics);
  }

  /** Show diagnostics, errors first. */
  report(diagnostics) {
    this.list.replaceChildren();
    if (!diagnostics.length) element(this.list, "li", {}, "no errors, no warnings");
    const order = [...diagnostics].sort((a, b) => (a.severity === "error" ? 0 : 1) - (b.severity === "error" ? 0 : 1));
    for (const { severity, place, message, code, hint } of order) {
      const item = element(this.list, "li", { class: severity === "error" ? "eu-live-problem" : "eu-warning" });
      element(item, "span", {}, `${place}: ${severity}: ${message} [${code}]`);
      if (hint) element(item, "div", {}, `hint: ${hint}`);
    }
  }

  analyzed({ singularity, held }) {
    this.meter.hidden = singularity === null;
    if (singularity === null) {
      this.gauge.textContent = "no loops, so no singularity of the closures";
      return;
    }
    this.farthest = Math.max(this.farthest, singularity);
    this.meter.value = this.farthest ? singularity / this.farthest : 0;
    const actuated = held === null ? "" : `; with every actuator held ${held.toPrecision(2)}`;
    this.gauge.textContent = `distance to singularity ${singularity.toPrecision(2)}${actuated}; 0 is singular`;
  }
}

/** The tab of the limits of passive joints. */
export class LimitsTab {
  constructor(parent) {
    parent.replaceChildren();
    this.parent = parent;
  }

  analyzed({ limits, reason }) {
    this.parent.replaceChildren();
    if (reason || !limits.length) {
      element(this.parent, "p", {}, reason || "the actuators determine no passive joint");
      return;
    }
    element(this.parent, "p", {}, "What the limits of the actuators allow at this configuration, at one joint at a time:");
    const table = element(this.parent, "table", { class: "eu-facts" });
    const head = element(element(table, "thead"), "tr");
    for (const title of ["passive joint", "velocity", "torque"]) element(head, "th", { scope: "col" }, title);
    const body = element(table, "tbody");
    for (const limit of limits) {
      const row = element(body, "tr");
      element(row, "th", { scope: "row" }, limit.name);
      for (const text of cells(limit)) element(row, "td", {}, text);
    }
  }
}

function cells({ unit, velocity, torque: [least, greatest] }) {
  const turns = velocity === null ? "no limit" : `± ${rounded(velocity)} ${unit}/s`;
  const force = unit === "m" ? "N" : "N·m";
  if (least === null && greatest === null) return [turns, "no limit"];
  const [low, high] = [least, greatest].map((each) => (each === null ? "no limit" : rounded(each)));
  return [turns, Math.abs(least + greatest) <= 1e-9 * Math.abs(greatest) ? `± ${high} ${force}` : `${low} to ${high} ${force}`];
}

/** The tab of the graph: SVG of the server, in which names are text. */
export function showGraph(parent, svg) {
  const { documentElement } = new DOMParser().parseFromString(svg, "image/svg+xml");
  parent.replaceChildren(document.importNode(documentElement, true));
}
