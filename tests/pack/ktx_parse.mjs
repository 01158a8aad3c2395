// Reads the files of write_ktx2 and of a bundle with ktx-parse, a reader that
// isn't ours. Usage: node ktx_parse.mjs FOLDER BUNDLE
import { readFileSync } from 'node:fs';
import { strict as assert } from 'node:assert';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [folder, bundle, modules] = process.argv.slice(2);
const { read } = await import(pathToFileURL(join(modules, 'ktx-parse/dist/ktx-parse.modern.js')));

const LINEAR = 1, SRGB = 2;
const formats = [
  { vk: 16, typeSize: 1, bits: 8, channels: [0, 1], transfer: LINEAR, lower: 0, upper: 255 },
  { vk: 37, typeSize: 1, bits: 8, channels: [0, 1, 2, 15], transfer: LINEAR, lower: 0, upper: 255 },
  { vk: 43, typeSize: 1, bits: 8, channels: [0, 1, 2, 15 | 0x10], transfer: SRGB, lower: 0, upper: 255 },
  { vk: 77, typeSize: 2, bits: 16, channels: [0, 1], transfer: LINEAR, lower: 0, upper: 65535 },
  { vk: 109, typeSize: 4, bits: 32, channels: [0xc0, 0xc1, 0xc2, 0xcf], transfer: LINEAR, lower: 0xbf800000, upper: 0x3f800000 },
];

function check(path, format, width, height, layers) {
  const bytes = readFileSync(path);
  const ktx = read(bytes);
  assert.equal(ktx.vkFormat, format.vk, path);
  assert.equal(ktx.typeSize, format.typeSize, path);
  assert.deepEqual([ktx.pixelWidth, ktx.pixelHeight, ktx.pixelDepth], [width, height, 0], path);
  assert.equal(ktx.layerCount, layers, path);
  assert.equal(ktx.faceCount, 1, path);
  assert.equal(ktx.supercompressionScheme, 0, path);
  assert.deepEqual(Object.keys(ktx.keyValue), ['KTXorientation', 'KTXwriter'], path);
  assert.equal(ktx.keyValue.KTXorientation, 'rd', path);
  const descriptor = ktx.dataFormatDescriptor[0];
  assert.equal(descriptor.colorModel, 1, path);
  assert.equal(descriptor.transferFunction, format.transfer, path);
  assert.deepEqual(descriptor.samples.map((s) => s.channelType), format.channels, path);
  descriptor.samples.forEach((sample, i) => {
    assert.equal(sample.bitOffset, i * format.bits, path);
    assert.equal(sample.bitLength, format.bits - 1, path);
    assert.equal(Number(sample.sampleLower) >>> 0, format.lower, path);
    assert.equal(Number(sample.sampleUpper) >>> 0, format.upper, path);
  });
  const texel = (format.bits / 8) * format.channels.length;
  assert.equal(descriptor.bytesPlane[0], texel, path);
  assert.equal(ktx.levels.length, 1, path);
  assert.equal(ktx.levels[0].levelData.byteLength, width * height * texel * layers, path);
  const offset = Number(bytes.readBigUInt64LE(80));
  assert.equal(offset % Math.max(4, texel), 0, path);
  return ktx.levels[0].levelData;
}

let count = 0;
for (const format of formats)
  for (const layers of [1, 2, 6, 7]) {
    const name = join(folder, `${format.vk}-${layers}`);
    const data = check(`${name}.ktx2`, format, 5, 3, layers);
    assert.ok(Buffer.from(data).equals(readFileSync(`${name}.raw`)), name);
    count++;
  }

const index = JSON.parse(readFileSync(join(bundle, 'bundle.json')));
const styles = index.styles.length, [width, height] = index.styles[0].size, lut = index.styles[0].lut.size;
const byVk = (vk) => formats.find((format) => format.vk === vk);
check(join(bundle, 'exemplars.ktx2'), byVk(43), width, height, styles);
check(join(bundle, 'guides.ktx2'), byVk(37), width, height, styles);
check(join(bundle, 'luts.ktx2'), byVk(77), lut, lut, styles);
check(join(bundle, 'params.ktx2'), byVk(109), styles, 5, 1);
check(join(bundle, 'jitter.ktx2'), byVk(16), 256, 256, 1);
console.log(`${count + 5} files read`);
