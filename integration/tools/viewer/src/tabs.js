// Tabs in the WAI-ARIA pattern: arrow keys switch tabs. A panel is drawn when its tab is shown.

// `draw(name)` fills the panel `panel-name`.
export function make_tabs(bar, draw) {
  const tabs = [...bar.querySelectorAll('[role=tab]')];
  let shown = tabs[0];
  const show = (tab) => {
    shown = tab;
    for (const one of tabs) {
      const chosen = one === tab;
      one.setAttribute('aria-selected', chosen ? 'true' : 'false');
      one.tabIndex = chosen ? 0 : -1;
      document.getElementById(one.getAttribute('aria-controls')).hidden = !chosen;
    }
    draw(tab.dataset.name);
  };
  for (const tab of tabs) tab.addEventListener('click', () => show(tab));
  bar.addEventListener('keydown', (event) => {
    const at = tabs.indexOf(document.activeElement), step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (step === undefined || at < 0) return;
    const next = tabs[(at + step + tabs.length) % tabs.length];
    next.focus();
    show(next);
  });
  return { show: (name) => show(tabs.find((tab) => tab.dataset.name === name)), redraw: () => show(shown) };
}
