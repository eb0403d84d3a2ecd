// What VS Code starts: the language server while a file of a robot is open, and previews of robots that move.

import { readFile, readdir } from "node:fs/promises";
import * as vscode from "vscode";
import { CloseAction, ErrorAction, LanguageClient } from "vscode-languageclient/node";
import { Preview } from "./preview.js";
import { isOfRobot, robotOf } from "./robot_files.js";
import { CANNOT_RUN, endOf, startServer } from "./server.js";

/** The path of a document with "/", as robot_files.js has paths. */
const pathOf = ({ fsPath }) => fsPath.replaceAll("\\", "/");

/** The documents that are open, saved or not, before the files on the disk. */
const files = {
  text: async (path) =>
    vscode.workspace.textDocuments.find(({ uri }) => uri.scheme === "file" && pathOf(uri) === path)?.getText() ?? readFile(path, "utf8"),
  bytes: (path) => readFile(path),
  list: (folder) => readdir(folder).catch(() => []),
};

/** The folder that meshes of a URDF may be in: that of the workspace, or its own. */
function rootOf(urdf) {
  const folder = vscode.workspace.getWorkspaceFolder(vscode.Uri.file(urdf));
  return folder ? `${pathOf(folder.uri)}/` : urdf.slice(0, urdf.lastIndexOf("/") + 1);
}

let serving = null; // a promise of the client that runs; of null, if it cannot until the setting changes

const serve = () => (serving ??= startClient(vscode.workspace.getConfiguration("eurdf").get("path")));

async function startClient(program) {
  let byDefault, ended, first;
  const start = async () => {
    const server = first ?? (await startServer(program));
    first = null;
    ended = endOf(server);
    return server;
  };
  const errorHandler = {
    error: () => ({ action: ErrorAction.Continue, handled: true }), // the end of the server follows
    closed: async () => {
      const { code, message } = await ended;
      return code === CANNOT_RUN ? { action: CloseAction.DoNotRestart, message, handled: true } : byDefault.closed();
    },
  };
  const initializationFailedHandler = () => false; // it is reported below
  const documentSelector = [{ scheme: "file", pattern: "**/*.{yaml,yml,urdf,xacro}" }]; // the server leaves out others
  try {
    first = await startServer(program);
    const client = new LanguageClient("eurdf", "Extended URDF", start, { documentSelector, errorHandler, initializationFailedHandler });
    byDefault = client.createDefaultErrorHandler();
    await client.start();
    return client;
  } catch (error) {
    vscode.window.showErrorMessage((await ended)?.message || `${error.message}.`);
    return null;
  }
}

async function stop() {
  const client = await serving;
  serving = null;
  await client?.dispose();
}

export function activate({ extensionUri, subscriptions }) {
  const { window, workspace, commands } = vscode;
  const previews = new Map(); // by the path of the URDF

  const opened = async (document) => {
    if (document.uri.scheme !== "file") return false;
    const isRobot = await isOfRobot({ path: pathOf(document.uri), text: document.getText() }, files);
    if (isRobot) serve();
    return isRobot;
  };
  const look = async () => {
    const document = window.activeTextEditor?.document;
    const isRobot = document ? await opened(document) : false;
    if (document === window.activeTextEditor?.document) commands.executeCommand("setContext", "eurdf.isRobot", isRobot);
  };
  const preview = async () => {
    const document = window.activeTextEditor?.document;
    try {
      if (!document) throw new Error("open a description or a URDF first");
      const { urdf } = await robotOf(pathOf(document.uri), files);
      const shown = previews.get(urdf);
      if (shown) return shown.reveal();
      const made = await Preview.of(pathOf(document.uri), { files, rootOf, folder: vscode.Uri.joinPath(extensionUri, "dist") });
      previews.set(urdf, made);
      made.panel.onDidDispose(() => previews.delete(urdf));
    } catch (error) {
      window.showErrorMessage(`No preview: ${error.message}.`);
    }
  };

  subscriptions.push(
    commands.registerCommand("eurdf.preview", preview),
    workspace.onDidOpenTextDocument(opened),
    window.onDidChangeActiveTextEditor(look),
    workspace.onDidChangeTextDocument(({ document }) => {
      if (document === window.activeTextEditor?.document) look();
      for (const each of previews.values()) each.changed(pathOf(document.uri));
    }),
    workspace.onDidChangeConfiguration(async (event) => {
      if (!event.affectsConfiguration("eurdf.path")) return;
      await stop();
      workspace.textDocuments.forEach(opened);
    }),
  );
  workspace.textDocuments.forEach(opened);
  look();
}

export const deactivate = stop;
