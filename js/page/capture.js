// What is drawn as a file: a picture, or a video while the robot moves.

import { Color } from "three";

const FRAMES = 30; // of a video, a second

/** Have the browser save a file. */
export function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name.replace(/[^\p{L}\p{N}._-]+/gu, "_");
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A picture with a transparent background. */
export async function takePicture({ renderer, scene, camera, canvas }, name) {
  renderer.render(scene, camera); // else the browser may have cleared what was drawn
  download(`${name}.png`, await new Promise((done) => canvas.toBlob(done)));
}

/** Begin a video; the result ends it and has the browser save it. */
export function takeVideo(viewport, name) {
  const { canvas, scene } = viewport;
  scene.background = new Color(getComputedStyle(document.body).backgroundColor); // a video is not transparent
  const recorder = new MediaRecorder(canvas.captureStream(FRAMES));
  const parts = [];
  recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
  recorder.addEventListener("stop", () => download(`${name}.webm`, new Blob(parts, { type: recorder.mimeType })));
  recorder.start();
  viewport.draw();
  return () => {
    recorder.stop();
    scene.background = null;
    viewport.draw();
  };
}
