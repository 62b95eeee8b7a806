// Lists passes and resources, with search and keyboard navigation.
import { h } from './dom.js';

// `items` is [{ kind, name, words, off }]. `choose(kind, name)` is called on selection;
// `found(names or null)` is called with the names that the search shows.
export function make_list(list, search, choose, found) {
  let items = [], selection = { kind: null, name: null };
  const matches = () => {
    const asked = search.value.trim().toLowerCase();
    return asked === '' ? items : items.filter((item) => item.words.includes(asked));
  };
  const draw = () => {
    const shown = matches();
    list.replaceChildren(...['pass', 'resource'].flatMap((kind) => {
      const mine = shown.filter((item) => item.kind === kind);
      return [h('li', { class: 'head', role: 'presentation' }, `${kind === 'pass' ? 'Passes' : 'Resources'} (${mine.length})`), ...mine.map((item) => {
        const chosen = item.kind === selection.kind && item.name === selection.name;
        return h('li', { role: 'presentation' }, h('button', { role: 'option', class: item.off ? 'off' : null, 'aria-selected': chosen ? 'true' : 'false', tabindex: chosen ? 0 : -1,
          'data-kind': item.kind, 'data-name': item.name, click: () => choose(item.kind, item.name) }, item.name, item.off && h('small', null, ' off')));
      })];
    }));
    const buttons = list.querySelectorAll('button');
    if (buttons.length > 0 && !list.querySelector('[tabindex="0"]')) buttons[0].tabIndex = 0;
    found(search.value.trim() === '' ? null : new Set(shown.map((item) => item.name)));
  };
  search.addEventListener('input', draw);
  search.addEventListener('keydown', (event) => {
    const first = matches()[0];
    if (event.key === 'Enter' && first) choose(first.kind, first.name);
    if (event.key === 'ArrowDown') list.querySelector('button')?.focus();
  });
  list.addEventListener('keydown', (event) => {
    const buttons = [...list.querySelectorAll('button')], at = buttons.indexOf(document.activeElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: buttons.length - 1 }[event.key];
    if (to === undefined || !buttons[to]) return;
    event.preventDefault();
    choose(buttons[to].dataset.kind, buttons[to].dataset.name);
    [...list.querySelectorAll('button')][to]?.focus();
  });
  return {
    show(next) { items = next; draw(); },
    select(kind, name) {
      selection = { kind, name };
      for (const button of list.querySelectorAll('button')) {
        const chosen = button.dataset.kind === kind && button.dataset.name === name;
        button.setAttribute('aria-selected', chosen ? 'true' : 'false');
        button.tabIndex = chosen ? 0 : -1;
        if (chosen) button.scrollIntoView({ block: 'nearest' });
      }
      const first = list.querySelector('button');
      if (first && !list.querySelector('[tabindex="0"]')) first.tabIndex = 0;
    },
  };
}
