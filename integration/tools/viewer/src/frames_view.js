// Shows a run's measurements: pass times, and per frame the time against the budget and the tile
// classes.
import uPlot from 'uplot';

import { h, milliseconds_text, table } from './dom.js';
import { color } from './theme.js';

const missing = (value) => (value === null || value === undefined || value < 0 ? null : value);

function plot(title, frames, series, width) {
  const axis = { stroke: color('--text'), grid: { stroke: color('--grid'), width: 1 }, ticks: { stroke: color('--grid') } };
  const target = h('div', { class: 'plot' });
  new uPlot({
    title, width, height: 220, scales: { x: { time: false } }, axes: [{ ...axis, label: 'frame' }, axis], cursor: { drag: { x: true, y: false } },
    series: [{ label: 'frame' }, ...series.map((one) => ({ label: one.label, stroke: color(one.color), width: 2, dash: one.dash, points: { show: frames.length < 60, size: 5 } }))],
  }, [frames.map((frame) => frame.frame), ...series.map((one) => frames.map(one.value))], target);
  return target;
}

export function show_frames(panel, report, choose) {
  if (report === null) {
    panel.replaceChildren(h('p', { class: 'quiet' }, 'No measurement in this page. To have one: '),
      h('pre', null, 'dermis render SCENE --graph FILE --json > report.json\ndermis graph FILE --frame report.json --html OUT.html'));
    return;
  }
  const total = report.passes.reduce((sum, pass) => sum + pass.milliseconds, 0);
  const slowest = Math.max(...report.passes.map((pass) => pass.milliseconds), 1e-9);
  const frames = report.choices ?? [];
  const width = Math.max(320, Math.min(560, panel.clientWidth - 40));
  panel.replaceChildren(
    h('p', { class: 'quiet' }, `${report.scene ?? ''} at ${report.width}x${report.height} on ${report.device ?? 'an unknown device'}: ${milliseconds_text(total)} of device time, medians of ${report.passes[0]?.frames ?? 0} frames.`),
    h('div', { class: 'memory' },
      table(['pass', 'time', ''], report.passes.map((pass) => ({ cells: [
        h('button', { class: 'link', click: () => choose('pass', pass.pass) }, pass.pass), milliseconds_text(pass.milliseconds),
        h('span', { class: 'bar', style: `width:${(120 * pass.milliseconds / slowest).toFixed(1)}px` })] }))),
      frames.length > 0 && h('div', null,
        plot('Device time, ms', frames, [
          { label: 'measured', color: '--accent', value: (frame) => missing(frame.measured_ms) },
          { label: 'predicted', color: '--past', dash: [6, 4], value: (frame) => missing(frame.predicted_ms) },
          { label: 'budget', color: '--slot', value: (frame) => (frame.budget_ms > 0 ? frame.budget_ms : null) }], width),
        plot('Tiles', frames, [
          { label: 'scatter', color: '--accent', value: (frame) => frame.scattering_tiles },
          { label: 'uniform light', color: '--past', value: (frame) => frame.uniform_tiles },
          { label: 'copied', color: '--slot', value: (frame) => frame.copied_tiles },
          { label: 'no subsurface', color: '--line', value: (frame) => Math.max(0, frame.view_tiles - frame.scattering_tiles - frame.uniform_tiles - frame.copied_tiles) }], width))),
    frames.length > 0 && table(['frame', 'ran', 'why', 'expected error'], frames.map((frame) => ({ cells: [frame.frame, frame.configuration, frame.why, frame.predicted_rmse.toExponential(2)] }))));
}
