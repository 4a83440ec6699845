// Colours that differ for colour-blind readers too: blue, orange, green, purple, ochre, red, sky, grey differ in
// lightness as well. Robots' are those of trajectory.svg.

export const robotColours = {
  light: ['#005aa0', '#c85000', '#008264', '#963282', '#aa7800', '#be283c', '#3c82be', '#5a5a5a'],
  dark: ['#6db5f0', '#ff9a4d', '#3fd0a8', '#d68ac8', '#e3b94a', '#ff7f8f', '#9ad0f5', '#b8b8b8'],
};

const kindColours = {
  light: { epuck: '#005aa0', i2c: '#008264', bytes: '#3c82be', xbee: '#963282', bluetooth: '#963282', can: '#aa7800',
    mesh: '#aa7800', rab: '#5a5a5a', light: '#5a5a5a', ircom: '#5a5a5a', log: '#7a8494', reset: '#be283c',
    fault: '#c04b00', failed: '#d05000' },
  dark: { epuck: '#6db5f0', i2c: '#3fd0a8', bytes: '#9ad0f5', xbee: '#d68ac8', bluetooth: '#d68ac8', can: '#e3b94a',
    mesh: '#e3b94a', rab: '#b8b8b8', light: '#b8b8b8', ircom: '#b8b8b8', log: '#8a95a6', reset: '#ff7f8f',
    fault: '#ff9a4d', failed: '#ff8a33' },
};

const surfaces = {
  light: { strong: '#005aa0', back: '#ffffff', part: '#f4f5f7', line: '#d4d8de', text: '#1d2430', dim: '#606b7a', wall: '#5b616b',
    thing: '#c9ced6', thingEdge: '#6d7683', lamp: '#e0a800', virtual: '#963282', tracker: '#aa7800', outside: '#e9ecf0', cursor: '#c04b00', floor: [70, 255],
    grid: 'rgba(60,75,95,0.13)' },
  dark: { strong: '#6db5f0', back: '#14181f', part: '#1b2029', line: '#323a47', text: '#e2e7ee', dim: '#96a1b1', wall: '#8b94a3',
    thing: '#4a5362', thingEdge: '#98a3b5', lamp: '#ffd34d', virtual: '#d68ac8', tracker: '#e3b94a', outside: '#0d1015', cursor: '#ff9a4d', floor: [12, 48],
    grid: 'rgba(200,215,235,0.10)' },
};

export function palette(dark) {
  const theme = dark ? 'dark' : 'light';
  const kinds = kindColours[theme], robots = robotColours[theme];
  return {
    ...surfaces[theme],
    robot: (index) => robots[index % robots.length],
    kind: (kind) => kinds[kind] || surfaces[theme].dim,
    failed: kinds.failed,
    delivered: robots[0],
    ircom: robots[3],
  };
}
