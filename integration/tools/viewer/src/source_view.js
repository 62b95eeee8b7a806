// Shows the files of the graph. Lines that declare a pass or resource select it, and a selection
// scrolls to its line.
import { by_id, h } from './dom.js';

// `declared` is [{ kind, name, file, line }].
export function make_source_view(panel, files, declared, choose) {
  let shown = -1;
  const select = h('select', { 'aria-label': 'File', change: () => show(select.selectedIndex) }, files.map((file) => h('option', null, file.name)));
  const list = h('ol', { class: 'source' });
  panel.replaceChildren(files.length > 1 ? select : h('p', { class: 'quiet' }, files[0]?.name ?? 'no file'), list);

  function show(file) {
    if (shown === file) return;
    shown = file;
    select.selectedIndex = file;
    const here = new Map(declared.filter((one) => one.file === file).map((one) => [one.line, one]));
    list.replaceChildren(...files[file].text.split('\n').map((text, index) => {
      const one = here.get(index + 1);
      return h('li', { id: `line-${index + 1}`, value: index + 1 },
        one ? h('button', { class: 'line', title: `Show ${one.kind} ${one.name}`, click: () => choose(one.kind, one.name) }, text) : h('code', null, text || ' '));
    }));
  }

  return {
    show(file, line) {
      show(file ?? Math.max(shown, 0));
      for (const one of list.querySelectorAll('.here')) one.classList.remove('here');
      const at = line ? by_id(`line-${line}`) : null;
      at?.classList.add('here');
      at?.scrollIntoView({ block: 'center' });
    },
  };
}
