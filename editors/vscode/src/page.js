// The page of a preview: the page of robots, in a view of the editor, which may load nothing.

/** What the editor adds: the theme, and other files after a change. A message is {content} or {problem}. */
const INSIDE = `
const root = document.querySelector(".eu-live");
const message = document.querySelector(".eu-message");
const useTheme = () => {
  const isDark = /vscode-dark|vscode-high-contrast(?!-light)/.test(document.body.className);
  const theme = isDark && !document.body.classList.contains("vscode-high-contrast-light") ? "dark" : "light";
  if (document.body.dataset.theme !== theme) document.body.dataset.theme = theme;
};
new MutationObserver(useTheme).observe(document.body, { attributeFilter: ["class"] });
useTheme();
addEventListener("message", ({ data: { content, problem } }) => {
  message.textContent = problem ?? "";
  if (content) root.dispatchEvent(new CustomEvent("eu-robot", { detail: content }));
});
`;

/** Colours of the editor for those of the page. */
const COLOURS = `
.eu-alone {
  --color-foreground-primary: var(--vscode-editor-foreground);
  --color-foreground-muted: var(--vscode-descriptionForeground);
  --color-background-primary: var(--vscode-editor-background);
  --color-background-secondary: var(--vscode-editorWidget-background);
  --color-background-border: var(--vscode-input-border, var(--vscode-contrastBorder, #8888));
  --color-brand-primary: var(--vscode-focusBorder);
  color: var(--vscode-editor-foreground);
  background: var(--vscode-editor-background);
}
.eu-alone[data-theme="light"] { color-scheme: light; }
.eu-alone[data-theme="dark"] { color-scheme: dark; }
`;

/**
 * HTML that shows a robot.
 *
 * @param content What `contentOf` gives.
 * @param script, style The bundles page.js and page.css of the package in JavaScript.
 * @param nonce A text that no one can guess, of letters and digits: only scripts and styles with it are used.
 */
export function previewPage(content, { script, style, nonce }) {
  // Buffers and textures in a mesh are read from addresses that contain them.
  const policy = `default-src 'none'; script-src 'nonce-${nonce}'; style-src 'nonce-${nonce}'; img-src data: blob:; connect-src data: blob:`;
  const data = JSON.stringify(content).replaceAll("<", "\\u003c");
  return [
    `<!doctype html><html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="${policy}">`,
    `<title>Extended URDF</title><style nonce="${nonce}">${style}${COLOURS}</style></head><body class="eu-alone">`,
    `<main><div class="eu-live"><script type="application/json" nonce="${nonce}">${data}</script></div>`,
    `<p class="eu-message" role="status"></p></main>`,
    `<script nonce="${nonce}">${script}</script><script nonce="${nonce}">${INSIDE}</script></body></html>`,
  ].join("\n");
}
