// martini's side of bench/peers: node martini.cjs MODULE HEIGHTS, then a question a line.
//
//   mesh METRES          milliseconds for errors and for the mesh, each of processor time (all threads of the process) and
//                        by the clock, then vertices and triangles
//   write METRES FILE    the mesh, as peers.cpp reads it
//
// What its constructor makes serves every tile of one size and is in no time.
const fs = require('fs');
const readline = require('readline');

const [, , modulePath, heightsFile] = process.argv;
const Martini = require(modulePath);
const bytes = fs.readFileSync(heightsFile);
const heights = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
const martini = new Martini(Math.sqrt(heights.length));

function timed(work) {
  const begun = performance.now(), worked = process.cpuUsage();
  const made = work();
  const {user, system} = process.cpuUsage(worked);
  return [made, `${(user + system) / 1000} ${performance.now() - begun}`];
}

function mesh(metres) {
  const [tile, errors] = timed(() => martini.createTile(heights));
  const [made, time] = timed(() => tile.getMesh(metres));
  return {made, errors, time};
}

readline.createInterface({input: process.stdin}).on('line', (line) => {
  const [verb, metres, file] = line.split(' ');
  const {made, errors, time} = mesh(Number(metres));
  const vertices = made.vertices.length / 2, triangles = made.triangles.length / 3;
  if (verb === 'write') {
    const part = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);
    fs.writeFileSync(file, Buffer.concat([part(Uint32Array.of(vertices, triangles)), part(made.vertices), part(made.triangles)]));
  }
  console.log(`${errors} ${time} ${vertices} ${triangles}`);
});
