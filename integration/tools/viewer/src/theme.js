// Light and dark themes: the system's preference, or the reader's choice.

const order = ['auto', 'light', 'dark'];

export function color(variable) {
  return getComputedStyle(document.documentElement).getPropertyValue(variable).trim();
}

// Calls `changed` whenever the colours change.
export function make_theme_button(button, changed) {
  let at = 0;
  const show = () => {
    button.textContent = `Theme: ${order[at]}`;
    if (order[at] === 'auto') delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = order[at];
  };
  button.addEventListener('click', () => {
    at = (at + 1) % order.length;
    show();
    changed();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);
  show();
}
