// A preview: a robot that moves, beside its texts, and follows them as they are typed.

import { randomBytes } from "node:crypto";
import { readFile } from "node:fs/promises";
import * as vscode from "vscode";
import { previewPage } from "./page.js";
import { contentOf, robotOf } from "./robot_files.js";

const PAUSE = 150; // without a change, before the robot is shown anew, ms

export class Preview {
  /**
   * The preview of the robot that a document belongs to. Throws `Error` if it has no URDF.
   *
   * @param options.files, options.rootOf See `contentOf`.
   * @param options.folder The URI of the folder with page.js and page.css.
   */
  static async of(path, { files, rootOf, folder }) {
    const made = new Preview();
    Object.assign(made, { path, files, rootOf, known: new Set() });
    const content = await made.content();
    const [script, style] = await Promise.all(
      ["page.js", "page.css"].map((name) => readFile(vscode.Uri.joinPath(folder, name).fsPath, "utf8")),
    );
    const name = made.robot.urdf.split("/").at(-2);
    made.panel = vscode.window.createWebviewPanel("eurdf.preview", `Preview ${name}`, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, {
      enableScripts: true,
      retainContextWhenHidden: true,
      localResourceRoots: [],
    });
    made.panel.webview.html = previewPage(content, { script, style, nonce: randomBytes(16).toString("hex") });
    made.panel.onDidDispose(() => clearTimeout(made.timer));
    return made;
  }

  async content() {
    this.robot = await robotOf(this.path, this.files);
    return contentOf(this.robot, this.rootOf(this.robot.urdf), this.files, this.known);
  }

  reveal() {
    this.panel.reveal(undefined, true);
  }

  /** Follow the text of a file of the robot. */
  changed(path) {
    if (![this.robot.description, this.robot.urdf].includes(path)) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.show(), PAUSE);
  }

  async show() {
    const message = await this.content().then(
      (content) => ({ content }),
      ({ message: problem }) => ({ problem }),
    );
    this.panel.webview.postMessage(message);
  }
}
