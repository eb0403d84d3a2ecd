// What the viewer adds to the panel of sliders: a filter, saving and copying the pose.

import { button, element } from "./elements.js";
import { toggle } from "./playing.js";
import { asPython, asYaml } from "./poses.js";

const MANY = 6; // sliders; more have a filter

export class MoveTab {
  /** @param panel The Panel; `before`: the tab of another version of the robot, whose texts are kept. */
  constructor(panel, connection, { saves, before }) {
    Object.assign(this, { panel, connection });
    if (panel.sliders.length > MANY) this.addFilter(before?.filter?.value ?? "");
    this.keeps = toggle(element(panel.form, "div", { class: "eu-row" }), "Parts keep their orientation", before?.keeps.checked ?? false, (on) => {
      panel.session.keepsRotation = on;
    });
    panel.session.keepsRotation = this.keeps.checked;
    const row = element(panel.form, "div", { class: "eu-row eu-save" });
    if (saves) this.addSave(row, before?.name?.value);
    button(row, "Copy as YAML", () => this.copy(asYaml(this.name?.value || "pose", panel.session.q)));
    button(row, "Copy as Python", () => this.copy(asPython(panel.session.q)));
    this.text = element(panel.form, "textarea", { readonly: "", hidden: "", rows: 4, "aria-label": "Pose" });
    this.asking = element(panel.form, "div", { class: "eu-row", role: "alert" });
    panel.form.append(panel.status);
  }

  addFilter(text) {
    const { sliders, form } = this.panel;
    this.filter = element(form, "input", { type: "search", placeholder: "Filter sliders", "aria-label": "Filter sliders" });
    form.insertBefore(this.filter, sliders[0].row.parentElement);
    this.filter.value = text;
    const show = () => {
      const words = this.filter.value.toLowerCase().split(/\s+/).filter(Boolean);
      for (const { coordinate, row } of sliders) row.hidden = !words.every((word) => coordinate.label.toLowerCase().includes(word));
    };
    this.filter.addEventListener("input", show);
    show();
  }

  addSave(row, name) {
    this.name = element(row, "input", { type: "text", "aria-label": "Name of the configuration", size: 10 });
    this.name.value = name || this.newName();
    this.name.addEventListener("input", () => this.asking.replaceChildren());
    button(row, "Save", () => this.save(false), { title: "write the pose to the description, as a named configuration" });
  }

  /** A name that no configuration has. */
  newName() {
    const { configurations } = this.panel.session;
    for (let count = 1; ; count += 1) if (!configurations.has(`pose_${count}`)) return `pose_${count}`;
  }

  save(replace) {
    this.asking.replaceChildren();
    this.connection.send("save", { name: this.name.value, replace });
  }

  /** There is another configuration of this name: ask. */
  exists({ name, text }) {
    this.asking.replaceChildren();
    element(this.asking, "span", {}, `${text}. `);
    button(this.asking, `Replace “${name}”`, () => this.save(true), { class: "eu-danger" });
    button(this.asking, "Cancel", () => this.asking.replaceChildren());
  }

  saved({ name, q }) {
    this.panel.session.configurations.set(name, q);
    this.panel.addConfiguration(name, q);
    this.asking.replaceChildren();
    if (this.name) this.name.value = this.newName();
  }

  /** To the clipboard; where the browser does not allow that, it is shown to be copied by hand. */
  async copy(text) {
    try {
      await navigator.clipboard.writeText(text);
      this.text.hidden = true;
      this.panel.say("The pose is on the clipboard.");
    } catch {
      this.text.hidden = false;
      this.text.value = text;
      this.text.select();
    }
  }
}
