// Tabs: one panel is shown at a time; arrow keys choose it.

import { element } from "./elements.js";

let count = 0;

export class Tabs {
  constructor(parent, label) {
    this.list = element(parent, "div", { class: "eu-tabs", role: "tablist", "aria-label": label });
    this.parent = parent;
    this.all = [];
    this.list.addEventListener("keydown", (event) => this.key(event));
  }

  /** Add a tab; the result is its panel. */
  add(name) {
    count += 1;
    const [tab, panel] = [`eu-tab-${count}`, `eu-panel-${count}`];
    const button = element(this.list, "button", { type: "button", role: "tab", id: tab, "aria-controls": panel }, name);
    const content = element(this.parent, "div", { class: "eu-tab", role: "tabpanel", id: panel, tabindex: 0, "aria-labelledby": tab });
    this.all.push({ button, content });
    button.addEventListener("click", () => this.choose(button));
    this.choose(this.all[0].button);
    return content;
  }

  choose(chosen) {
    for (const { button, content } of this.all) {
      const isChosen = button === chosen;
      button.setAttribute("aria-selected", String(isChosen));
      button.tabIndex = isChosen ? 0 : -1;
      content.hidden = !isChosen;
    }
  }

  key({ key }) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[key];
    if (!step) return;
    const at = this.all.findIndex(({ content }) => !content.hidden);
    const { button } = this.all.at((at + step) % this.all.length);
    this.choose(button);
    button.focus();
  }
}
