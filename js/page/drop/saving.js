// Files that leave the page: downloads, and a picture of the robot.

/** Offer a Blob, or a text with its type, as a download. */
export function save(content, name, type) {
  const address = URL.createObjectURL(new Blob([content], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000); // the browser reads it later
}

/** A PNG of what a viewport shows, on the colour of the page. */
export function pictureOf({ renderer, scene, camera, canvas }) {
  renderer.render(scene, camera); // what was drawn is gone after its frame
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [canvas.width, canvas.height];
  const context = picture.getContext("2d");
  context.fillStyle = getComputedStyle(document.body).backgroundColor;
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(canvas, 0, 0);
  return new Promise((done, failed) =>
    picture.toBlob(
      (blob) => (blob ? done(blob) : failed(new Error("the browser does not make a picture"))),
      "image/png",
    ),
  );
}
