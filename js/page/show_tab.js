// The tab of what is shown: layers, the direction of the camera, what it follows, pictures and videos.

import { DIRECTIONS, Follower } from "./camera.js";
import { takePicture, takeVideo } from "./capture.js";
import { button, element } from "./elements.js";
import { AXES, Layers, layersOf } from "./layers.js";
import { select, toggle } from "./playing.js";

const LEGEND = [["motor", "motor"], ["passive", "passive joint"], ["dependent", "dependent actuator"]];

export class ShowTab {
  /** @param before The tab of another version of the robot, whose choices are kept. */
  constructor(parent, { viewport, scene, session }, { mesh, dependent, before }) {
    Object.assign(this, { viewport, scene, session });
    parent.replaceChildren();
    before?.layers.dispose();
    this.layers = new Layers(scene, { mesh, viewport, dependent });
    this.follower = before?.follower ?? new Follower(viewport);
    this.on = before?.on ?? new Map([["visual", true], ["closures", true]]);
    const box = element(element(parent, "fieldset"), "legend", {}, "Layers").parentElement;
    for (const [name, title] of layersOf(session)) {
      const on = this.on.get(name) ?? false;
      toggle(box, title, on, (now) => {
        this.on.set(name, now);
        this.layers.show(name, now);
        this.legend.hidden = !this.on.get("axes");
      });
      if (name === "axes") this.addLegend(box);
      if (on || name === "closures") this.layers.show(name, on);
    }
    this.legend ??= { hidden: true };
    this.addCamera(parent, before?.followed?.value);
    this.addCapture(parent);
    session.addEventListener("change", () => {
      this.layers.place();
      this.follower.place(session);
    });
  }

  addLegend(box) {
    this.legend = element(box, "p", { class: "eu-legend" });
    for (const [kind, text] of LEGEND) {
      const mark = element(this.legend, "span", {}, "■ ");
      mark.style.color = `#${AXES[kind].toString(16).padStart(6, "0")}`;
      element(this.legend, "span", {}, `${text} `);
    }
    this.legend.hidden = !this.on.get("axes");
  }

  addCamera(parent, followed) {
    const { viewport, session } = this;
    const box = element(element(parent, "fieldset"), "legend", {}, "Camera").parentElement;
    button(box, "Home", () => viewport.home());
    for (const [name, direction] of Object.entries(DIRECTIONS)) button(box, name, () => viewport.view(...direction));
    const links = [...session.robot.links.keys()];
    const center = session.kinematics.centerOfMass() ? [["center", "center of mass"]] : [];
    this.followed = select(box, "Follow", [["", "nothing"], ...center, ...links.map((name) => [`link ${name}`, name])], followed);
    const follow = () => this.follower.follow(pointOf(this.followed.value), session);
    this.followed.addEventListener("change", follow);
    follow();
  }

  addCapture(parent) {
    const { viewport, session } = this;
    const box = element(element(parent, "fieldset"), "legend", {}, "Picture").parentElement;
    button(box, "Save a picture", () => takePicture(viewport, session.robot.name));
    if (!globalThis.MediaRecorder) return;
    let end = null;
    const record = button(box, "Record a video", () => {
      if (end) end();
      end = end ? null : takeVideo(viewport, session.robot.name);
      record.textContent = end ? "End the video" : "Record a video";
    });
  }
}

/** The point that is followed: a function of a session. */
function pointOf(choice) {
  if (choice === "center") return ({ kinematics }) => kinematics.centerOfMass();
  const link = choice.slice("link ".length);
  return choice ? ({ kinematics }) => kinematics.pose(link).p : null;
}
