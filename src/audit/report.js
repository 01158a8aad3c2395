
'use strict'
// What goes wrong must be seen, by people and by tests.
function complain(what) {
  const box = document.getElementById('trouble')
  box.hidden = false
  box.textContent += `This page failed: ${what}\n`
}
window.addEventListener('error', event => complain(event.message))
window.addEventListener('unhandledrejection', event => complain(event.reason))

const $ = id => document.getElementById(id)
const readJson = id => JSON.parse($(id).textContent)
const audit = readJson('audit'), facts = readJson('facts')
const LEVEL = 2 / 255, NONE = 65535

// ---- planes --------------------------------------------------------------------

async function inflate(text) {
  const packed = Uint8Array.from(atob(text), c => c.charCodeAt(0))
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate-raw'))
  return new Uint8Array(await new Response(stream).arrayBuffer())
}

// High bytes, then low bytes, of differences along each row.
async function readPlane(plane, width, height) {
  const bytes = await inflate(plane.data), count = width * height, values = new Float64Array(count)
  for (let i = 0, v = 0; i < count; i++) {
    if (i % width === 0) v = 0
    v = v + (bytes[i] << 8) + bytes[count + i] & 65535
    values[i] = v === NONE ? NaN : v * plane.scale
  }
  return values
}

async function readGrid(id) {
  const grid = readJson(id), planes = {}
  for (const name of Object.keys(grid.planes)) planes[name] = await readPlane(grid.planes[name], grid.width, grid.height)
  return { width: grid.width, height: grid.height, step: grid.step, ...planes }
}

// ---- guide values and texels: stylut/lut.h says the same -------------------------

const [texelsX, texelsY] = facts.texels, [sourceX, sourceY] = facts.source

function getTexelValue(i, j) {
  let x = (i + 0.5) / texelsX * 2 - 1, y = 1 - (j + 0.5) / texelsY * 2
  if (audit.sampling === 'unorm8') [x, y] = [i / (texelsX - 1) * 2 - 1, 1 - j / (texelsY - 1) * 2]
  if (audit.sampling === 'corner') [x, y] = [i / texelsX * 2 - 1, (texelsY - 1 - j) / texelsY * 2 - 1]
  if (audit.map !== 'equal-area') return [x, y]
  const squared = x * x + y * y
  const k = squared > 1 ? 1 / Math.sqrt(squared) : Math.sqrt(2 - squared)
  return [x * k, y * k]
}

function findTexel(gx, gy) {
  if (audit.map === 'equal-area') {
    const squared = gx * gx + gy * gy
    const k = squared > 1 ? 1 / Math.sqrt(squared) : 1 / Math.sqrt(1 + Math.sqrt(1 - squared))
    gx *= k
    gy *= k
  }
  const find = (h, side) => {
    const at = audit.sampling === 'unorm8' ? Math.round(h * (side - 1)) : Math.floor(h * side)
    return Math.min(Math.max(at, 0), side - 1)
  }
  return [find(gx / 2 + 0.5, texelsX), find(0.5 - gy / 2, texelsY)]
}

// ---- colours ---------------------------------------------------------------------

function convertOklch(lightness, chroma, hue) {
  const a = chroma * Math.cos(hue * Math.PI / 180), b = chroma * Math.sin(hue * Math.PI / 180)
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3
  return [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s]
}
const encode = v => 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055)
const decode = v => v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4
const getLuminance = c => 0.2126 * decode(c[0]) + 0.7152 * decode(c[1]) + 0.0722 * decode(c[2])

// Light for little, dark for much, with luminance falling evenly on the way.
function makeRamp(hueFrom, hueTo, chroma) {
  const ramp = []
  for (let i = 0; i < 256; i++) {
    const t = i / 255, hue = hueFrom + (hueTo - hueFrom) * t
    let strength = chroma * Math.sin(Math.PI * (0.08 + 0.8 * t)), linear
    do {
      linear = convertOklch(0.965 - 0.69 * t, strength, hue)
      strength *= 0.97
    } while (linear.some(v => v < 0 || v > 1) && strength > 1e-3)
    ramp.push(linear.map(v => Math.round(encode(Math.min(Math.max(v, 0), 1)))))
  }
  return ramp
}
const ramps = { warm: makeRamp(95, -60, 0.19), cool: makeRamp(150, 285, 0.15), plain: makeRamp(250, 280, 0.12) }
const UNASKED = [233, 234, 238]

// The four corners of the source in four hues; a board of 16 squares shows what is cut.
const corners = [[58, 104, 232], [255, 214, 84], [22, 178, 134], [236, 66, 96]]
function colourSource(u, v) {
  const dark = Math.floor(u * 16) + Math.floor(v * 16) & 1 ? 0.84 : 1
  return [0, 1, 2].map(k => dark * ((corners[0][k] * (1 - u) + corners[1][k] * u) * (1 - v) + (corners[2][k] * (1 - u) + corners[3][k] * u) * v))
}

function paint(canvas, width, height, colour) {
  canvas.width = width
  canvas.height = height
  const context = canvas.getContext('2d'), image = context.createImageData(width, height)
  for (let i = 0; i < width * height; i++) {
    const c = colour(i)
    if (c) image.data.set([c[0], c[1], c[2], 255], 4 * i)
  }
  context.putImageData(image, 0, 0)
}

// ---- numbers for people ------------------------------------------------------------

function show(value, digits = 3) {
  if (value === 0) return '0'
  const size = Math.abs(value)
  if (size < 1e-4) return value.toExponential(1).replace('-', '\u2212').replace('e\u2212', 'e-')
  return Number(value.toPrecision(size >= 100 ? Math.max(digits, Math.ceil(Math.log10(size + 1))) : digits)).toString().replace('-', '\u2212')
}
function showShare(share) {
  if (share > 0 && share < 0.0005) return '< 0.1 %'
  if (share < 1 && share > 0.9995) return '> 99.9 %'
  return `${(100 * share).toFixed(share < 0.1 && share > 0 ? 2 : share === 1 || share === 0 ? 0 : 1)} %`
}
const showCount = n => String(n).replace(/\B(?=(\d{3})+$)/g, '\u202f')

function showDirection(gx, gy) {
  const tilt = Math.asin(Math.min(Math.hypot(gx, gy), 1)) * 180 / Math.PI
  const ways = ['right', 'upper right', 'top', 'upper left', 'left', 'lower left', 'bottom', 'lower right']
  const way = ways[(Math.round(Math.atan2(gy, gx) / (Math.PI / 4)) + 8) % 8]
  return tilt < 0.5 ? 'straight at the viewer' : `${tilt.toFixed(0)}\u00b0 to the ${way}`
}

// ---- the maps ------------------------------------------------------------------------

const perCell = grid => grid.step > 1 ? ` Each cell shows ${grid.step} \u00d7 ${grid.step} texels by their worst.` : ''
function listMaps(table) {
  const maps = [
    { id: 'source', name: 'Table', about: 'which place on the guide each texel names; where the board is torn, strokes are.' },
    { id: 'error', name: 'Error', unit: '\u00b0', ramp: 'warm', about: 'angle between the direction asked for and the pixel given.' },
    { id: 'excess', name: 'Excess', unit: '\u00b0', ramp: 'warm', about: 'error above that of the best possible table.' },
    { id: 'pieces', name: 'Pieces', unit: '', ramp: 'cool', log: true, about: 'how many separate places on the guide fit equally well.' },
    { id: 'spread', name: 'Spread', unit: ' px', ramp: 'cool', least: audit.jump, about: 'how far the fitting pixels lie from their middle.' },
    { id: 'jumps', name: 'Jumps', share: true, ramp: 'cool', about: `neighbours that lie more than ${show(audit.jump)} source pixels away.` },
    { id: 'unstable', name: 'Unstable', share: true, ramp: 'cool', about: 'how often rounding of the guide sends the texel elsewhere.' },
  ]
  if (audit.weights !== 'disc')
    maps.push({ id: 'weight', name: facts.frames ? 'Demand' : 'Weight', unit: '\u00d7', log: true, ramp: 'plain',
      about: `${facts.frames ? 'how often the frames ask for the texel' : 'what the texel counts'}, as a multiple of the average.` })
  for (const map of maps) if (map.id !== 'source') Object.assign(map, measureScale(map, table[map.id]))
  return maps
}

// Where a map's colours begin and end; the last hundredth is left to the darkest.
function measureScale(map, values) {
  const sorted = values.filter(v => !Number.isNaN(v)).sort()
  const most = sorted.length ? sorted[sorted.length - 1] : 0, p99 = sorted[Math.floor((sorted.length - 1) * 0.99)] || 0
  const clipped = !map.share && p99 > 0 && most > 1.3 * p99
  const to = map.share ? 1 : Math.max(clipped ? p99 : most, map.least || 0)
  if (map.log) return { from: map.id === 'pieces' ? 1 : to / 1000, to, most, clipped }
  return { from: 0, to, most, clipped }
}

function getPlace(map, value) {
  if (!(map.to > map.from)) return value > map.from ? 1 : 0
  const t = map.log ? Math.log(Math.max(value, map.from) / map.from) / Math.log(map.to / map.from) : (value - map.from) / (map.to - map.from)
  return Math.min(Math.max(t, 0), 1)
}

function colourCell(map, table, i) {
  if (Number.isNaN(table.x[i])) return null
  if (map.id === 'source') return colourSource(...placeSource(table.x[i], table.y[i]))
  const value = table[map.id][i]
  if (Number.isNaN(value) || map.id === 'weight' && value === 0) return UNASKED
  return ramps[map.ramp][Math.round(255 * getPlace(map, value))]
}

const showValue = (map, value) => map.share ? showShare(value) : show(value) + (map.unit || '')

function listTicks(map) {
  if (!map.log) {
    const ticks = listAxisTicks(map).filter(v => !map.clipped || v < 0.88 * map.to)
    return map.clipped ? [...ticks, map.to] : ticks
  }
  const ticks = []
  for (let decade = Math.floor(Math.log10(map.from)); decade <= Math.log10(map.to); decade++)
    for (const k of map.to / map.from < 50 ? [1, 2, 5] : [1]) {
      const value = k * 10 ** decade
      if (value >= map.from * 0.999 && value <= map.to * 1.001) ticks.push(value)
    }
  return ticks
}

function drawLegend(map) {
  const box = $('legend')
  box.textContent = ''
  if (map.id === 'source') {
    const row = box.appendChild(make('div', { class: 'row' })), canvas = row.appendChild(make('canvas'))
    paint(canvas, 64, 64, i => colourSource((i % 64 + 0.5) / 64, (Math.floor(i / 64) + 0.5) / 64))
    const { x, y, width, height } = state.crop, step = state.guide.step
    row.append(make('span', {}, `Colours are places on the guide as shown beside: x from ${x * step} to ${Math.min((x + width) * step, sourceX) - 1}, y from ${y * step} to ${Math.min((y + height) * step, sourceY) - 1}.`))
    return
  }
  if (!(map.to > map.from)) {
    box.append(make('p', {}, `${showValue(map, map.to)} everywhere.`))
    return
  }
  const svg = box.appendChild(draw('svg', { viewBox: '0 0 512 46', role: 'img', 'aria-label': `from ${showValue(map, map.from)} to ${showValue(map, map.most)}` }))
  for (let i = 0; i < 256; i++) svg.append(draw('rect', { x: 2 * i, y: 2, width: 2.5, height: 14, fill: `rgb(${ramps[map.ramp][i]})` }))
  for (const value of listTicks(map)) {
    const x = 512 * getPlace(map, value)
    svg.append(draw('line', { x1: x, x2: x, y1: 16, y2: 21, stroke: '#5b6672' }))
    svg.append(draw('text', { x, y: 34, 'text-anchor': x < 20 ? 'start' : x > 490 ? 'end' : 'middle' }, (map.clipped && x > 511 ? '\u2265 ' : '') + showValue(map, value)))
  }
  let note = map.clipped ? `The darkest holds the last hundredth, up to ${showValue(map, map.most)}. ` : ''
  if (map.unasked) note += 'Grey: not asked for by the frames.'
  if (note) box.append(make('span', {}, note))
}

// ---- elements --------------------------------------------------------------------------

function make(name, attributes = {}, text) {
  const element = document.createElement(name)
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value)
  if (text !== undefined) element.textContent = text
  return element
}
function draw(name, attributes = {}, text) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name)
  for (const [key, value] of Object.entries(attributes))
    element.setAttribute(key, typeof value === 'number' ? Math.round(value * 100) / 100 : value)
  if (text !== undefined) element.textContent = text
  return element
}

function fillTiles() {
  const tiles = [
    [showShare(audit.optimal), 'texels that hold the nearest pixel'],
    [`${show(audit.lookup.mean)}\u00b0`, 'mean lookup error'],
    [`${show(audit.lookup.p99)}\u00b0`, 'p99 of the lookup error'],
    [showShare(audit.ambiguous), 'texels are ambiguous'],
    [showShare(audit.jumps), 'neighbouring texels jump'],
    [showShare(audit.unstable), 'unstable under rounding'],
    [showShare(audit.coverage), 'directions covered'],
    [showShare(audit.unused), 'guide pixels never used'],
  ]
  for (const [value, name] of tiles) {
    const tile = $('tiles').appendChild(make('li'))
    tile.append(make('b', {}, value), make('span', {}, name))
  }
}

// ---- the two pictures and what is read out ------------------------------------------------

const overlays = [
  { id: 'alike', name: 'lookalikes', about: 'in pink, pixels that face as the chosen texel asks, paler where nearly so; many places mean an ambiguous guide.' },
  { id: 'ambiguous', name: 'ambiguous', about: 'in pink, pixels whose direction others show equally well.' },
  { id: 'unused', name: 'unused', about: 'in pink, pixels that no texel names.' },
  { id: 'none', name: 'normals', about: 'as colours: right is red, up is green.' },
]
const state = { table: null, guide: null, crop: null, maps: null, map: null, overlay: overlays[0], cell: [0, 0], held: false }

const getCellTexel = (c, side) => Math.min(c * state.table.step + (state.table.step >> 1), side - 1)
const getTexel = () => [getCellTexel(state.cell[0], texelsX), getCellTexel(state.cell[1], texelsY)]

function paintTable() {
  paint($('table-map'), state.table.width, state.table.height, i => colourCell(state.map, state.table, i))
  $('map-name').textContent = `${state.map.name}:`
  $('map-about').textContent = state.map.about + (state.map.id === 'source' ? '' : perCell(state.table))
  drawLegend(state.map)
}

// How strongly the overlay covers cell i of the guide, 0 to 1; the form below stays to be seen.
function getCover(i, asked) {
  const guide = state.guide
  if (state.overlay.id === 'none') return 0
  if (state.overlay.id !== 'alike') return 0.7 * (guide[state.overlay.id][i] || 0)
  const reach = Math.max(audit.tolerance, 2 / Math.max(texelsX, texelsY))
  const distance = Math.hypot(guide.gx[i] * 2 - 1 - asked[0], guide.gy[i] * 2 - 1 - asked[1])
  return Math.min(Math.max(1.5 - distance / reach / 2, 0), 1)
}

function paintGuide() {
  const { guide, crop } = state, asked = getTexelValue(...getTexel()), fade = state.overlay.id === 'none' ? 0 : 0.55
  const pink = [196, 0, 110]
  paint($('guide-map'), crop.width, crop.height, k => {
    const i = (crop.y + Math.floor(k / crop.width)) * guide.width + crop.x + k % crop.width
    if (Number.isNaN(guide.gx[i])) return null
    const z = Math.sqrt(Math.max(0, 1 - (guide.gx[i] * 2 - 1) ** 2 - (guide.gy[i] * 2 - 1) ** 2))
    const cover = getCover(i, asked)
    return [guide.gx[i], guide.gy[i], z / 2 + 0.5].map((v, c) => (1 - cover) * (255 * (v + (1 - v) * fade)) + cover * pink[c])
  })
  const share = { ambiguous: () => measureCover('ambiguous'), unused: () => audit.unused }[state.overlay.id]
  $('overlay-about').textContent = state.overlay.about + (share ? ` ${showShare(share())} of the pixels.` : '')
}

function measureCover(name) {
  let sum = 0, count = 0
  for (const v of state.guide[name]) if (!Number.isNaN(v)) sum += v, count++
  return count ? sum / count : 0
}

// The part of the guide that is covered or named by the table, with a margin, in cells.
function measureCrop(table, guide) {
  const box = { x: [Infinity, -Infinity], y: [Infinity, -Infinity] }
  const include = (x, y) => {
    box.x = [Math.min(box.x[0], x), Math.max(box.x[1], x)]
    box.y = [Math.min(box.y[0], y), Math.max(box.y[1], y)]
  }
  guide.gx.forEach((gx, i) => { if (!Number.isNaN(gx)) include(i % guide.width, Math.floor(i / guide.width)) })
  table.x.forEach((x, i) => { if (!Number.isNaN(x)) include(Math.floor(x / guide.step), Math.floor(table.y[i] / guide.step)) })
  const margin = Math.ceil(0.02 * Math.max(box.x[1] - box.x[0], box.y[1] - box.y[0]))
  const x = Math.max(box.x[0] - margin, 0), y = Math.max(box.y[0] - margin, 0)
  return { x, y, width: Math.min(box.x[1] + margin, guide.width - 1) - x + 1, height: Math.min(box.y[1] + margin, guide.height - 1) - y + 1 }
}

// A source pixel's place in the guide as shown, 0 to 1.
function placeSource(x, y) {
  const { crop, guide } = state
  return [((x + 0.5) / guide.step - crop.x) / crop.width, ((y + 0.5) / guide.step - crop.y) / crop.height]
}

function place(ring, x, y) {
  ring.hidden = !(x >= 0 && y >= 0)
  ring.style.left = `${100 * x}%`
  ring.style.top = `${100 * y}%`
  ring.classList.toggle('held', state.held)
}

function listValues() {
  const table = state.table, i = state.cell[1] * table.width + state.cell[0], [x, y] = getTexel(), g = getTexelValue(x, y)
  const range = (c, side) => table.step > 1 ? `${c * table.step}\u2013${Math.min((c + 1) * table.step, side) - 1}` : c
  const feasible = !Number.isNaN(table.x[i])
  const rows = [
    ['texel', 'texel', [x, y], `${range(state.cell[0], texelsX)}, ${range(state.cell[1], texelsY)}`],
    ['source', 'source pixel', [table.x[i], table.y[i]], feasible ? `${table.x[i]}, ${table.y[i]}` : 'outside the disc'],
    ['asked', 'asks for', g, `${g.map(v => v.toFixed(4).replace('-', '\u2212')).join(', ')} \u2013 ${showDirection(...g)}`, 'wide'],
  ]
  for (const map of state.maps) {
    if (map.id === 'source') continue
    const value = table[map.id][i]
    const background = (map.id === 'error') && value > 179.99
    rows.push([map.id, map.name.toLowerCase(), value, Number.isNaN(value) ? '\u2013' : background ? 'background' : showValue(map, value)])
  }
  return rows
}

function fillReadout() {
  const box = $('values')
  box.textContent = ''
  for (const [id, name, value, text, kind] of listValues()) {
    box.append(make('dt', {}, name))
    box.append(make('dd', { id: `at-${id}`, 'data-value': [value].flat().join(','), class: kind || '' }, text))
  }
  const [x, y] = getTexel()
  if (document.activeElement !== $('go-x')) $('go-x').value = x
  if (document.activeElement !== $('go-y')) $('go-y').value = y
}

function moveTo(column, row) {
  const table = state.table
  state.cell = [Math.min(Math.max(column, 0), table.width - 1), Math.min(Math.max(row, 0), table.height - 1)]
  const i = state.cell[1] * table.width + state.cell[0]
  place($('table-ring'), (state.cell[0] + 0.5) / table.width, (state.cell[1] + 0.5) / table.height)
  place($('guide-ring'), ...placeSource(table.x[i], table.y[i]))
  fillReadout()
  if (state.overlay.id === 'alike') paintGuide()
}
const moveToTexel = (x, y) => moveTo(Math.floor(x / state.table.step), Math.floor(y / state.table.step))

// The cell of a canvas under the pointer.
function findCell(event) {
  const canvas = event.target, box = canvas.getBoundingClientRect()
  return [Math.floor((event.clientX - box.left) / box.width * canvas.width), Math.floor((event.clientY - box.top) / box.height * canvas.height)]
}

function hold(held) {
  state.held = held
  moveTo(...state.cell)
}

function pointAtTable(event) {
  moveTo(...findCell(event))
}
function pointAtGuide(event) {
  const { guide, crop } = state, [x, y] = findCell(event), i = (crop.y + y) * guide.width + crop.x + x
  if (x >= 0 && y >= 0 && x < crop.width && y < crop.height && !Number.isNaN(guide.gx[i]))
    moveToTexel(...findTexel(guide.gx[i] * 2 - 1, guide.gy[i] * 2 - 1))
}

function listenToPointers() {
  for (const [id, point] of [['table-map', pointAtTable], ['guide-map', pointAtGuide]]) {
    let waiting = null
    $(id).addEventListener('pointermove', event => {
      if (state.held) return
      if (!waiting) requestAnimationFrame(() => { point(waiting); waiting = null })
      waiting = event
    })
    $(id).addEventListener('pointerdown', event => {
      point(event)
      hold(!state.held)
    })
  }
}

function listenToKeys() {
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }
  $('table-map').addEventListener('keydown', event => {
    if (event.key === ' ') hold(!state.held)
    else if (steps[event.key]) moveTo(...state.cell.map((c, k) => c + steps[event.key][k] * (event.shiftKey ? 10 : 1)))
    else return
    event.preventDefault()
  })
  $('go').addEventListener('submit', event => event.preventDefault())
  for (const id of ['go-x', 'go-y']) {
    $(id).max = (id === 'go-x' ? texelsX : texelsY) - 1
    $(id).addEventListener('input', () => { hold(true); moveToTexel(Number($('go-x').value), Number($('go-y').value)) })
  }
}

function findMost(name) {
  const values = state.table[name]
  let best = -1
  for (let i = 0; i < values.length; i++) if (values[i] > (best < 0 ? 0 : values[best])) best = i
  return best
}

function addShortcuts() {
  const places = [['worst error', 'error'], ['worst excess', 'excess'], ['most pieces', 'pieces'], ['most wanted', 'weight']]
  for (const [name, map] of places) {
    if (!state.maps.some(m => m.id === map)) continue
    const i = findMost(map)
    if (i < 0 || map === 'pieces' && state.table.pieces[i] < 2) continue
    const button = $('shortcuts').appendChild(make('button', { type: 'button' }, name))
    button.addEventListener('click', () => { hold(true); moveTo(i % state.table.width, Math.floor(i / state.table.width)) })
  }
}

function addChoices() {
  for (const map of state.maps) {
    const label = $('choices').appendChild(make('label')), input = label.appendChild(make('input', { type: 'radio', name: 'map', value: map.id }))
    const canvas = label.appendChild(make('canvas', { 'aria-hidden': 'true' }))
    paint(canvas, state.table.width, state.table.height, i => colourCell(map, state.table, i))
    label.append(map.name)
    input.checked = map === state.map
    input.addEventListener('change', () => { state.map = map; paintTable() })
  }
  for (const overlay of overlays) {
    const label = $('overlays').appendChild(make('label')), input = label.appendChild(make('input', { type: 'radio', name: 'overlay', value: overlay.id }))
    label.append(` ${overlay.name}`)
    input.checked = overlay === state.overlay
    input.addEventListener('change', () => { state.overlay = overlay; paintGuide() })
  }
}

// ---- charts ---------------------------------------------------------------------------------

const WIDTH = 360, HEIGHT = 246, LEFT = 44, RIGHT = 12, TOP = 44, BOTTOM = 40
const blue = '#2b5fa8', orange = '#c96a12', grey = '#8a949f'

function addCard(title, about) {
  const figure = $('charts').appendChild(make('figure')), caption = figure.appendChild(make('figcaption'))
  caption.append(make('h3', {}, title), make('span', {}, about))
  return figure
}
const addSvg = (card, label) => card.appendChild(draw('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': label }))

function makeAxis(from, to, at, length, log) {
  const axis = v => at + length * (log ? Math.log(Math.max(v, from) / from) / Math.log(to / from) : (v - from) / (to - from))
  return Object.assign(axis, { from, to, log })
}
function listAxisTicks(axis) {
  const ticks = []
  if (axis.log) {
    const wide = axis.to / axis.from > 30
    for (let d = Math.floor(Math.log10(axis.from)); d <= Math.ceil(Math.log10(axis.to)); d++)
      for (const k of wide ? [1] : [1, 2, 5]) ticks.push(k * 10 ** d)
  } else {
    const raw = (axis.to - axis.from) / 4, power = 10 ** Math.floor(Math.log10(raw)), step = power * [1, 2, 2.5, 5, 10].find(k => k * power >= raw * 0.999)
    for (let v = axis.from; v <= axis.to * 1.0001; v += step) ticks.push(v)
  }
  return ticks.filter(v => v >= axis.from * 0.999 && v <= axis.to * 1.001)
}
function drawAxes(svg, x, y, showX, showY, name) {
  const bottom = HEIGHT - BOTTOM
  for (const v of listAxisTicks(y)) {
    svg.append(draw('line', { x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v), stroke: '#e8ebef' }))
    svg.append(draw('text', { x: LEFT - 6, y: y(v) + 4, 'text-anchor': 'end' }, showY(v)))
  }
  for (const v of listAxisTicks(x)) {
    svg.append(draw('line', { x1: x(v), x2: x(v), y1: bottom, y2: bottom + 4, stroke: grey }))
    svg.append(draw('text', { x: x(v), y: bottom + 16, 'text-anchor': 'middle' }, showX(v)))
  }
  svg.append(draw('line', { x1: LEFT, x2: WIDTH - RIGHT, y1: bottom, y2: bottom, stroke: grey }))
  svg.append(draw('text', { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 5, 'text-anchor': 'middle' }, name))
}
const drawLine = (svg, points, colour, extra = {}) =>
  svg.append(draw('polyline', { points: points.map(p => p.map(v => v.toFixed(1)).join()).join(' '), fill: 'none', stroke: colour, 'stroke-width': 2, 'stroke-linejoin': 'round', ...extra }))
function drawKey(svg, entries) {
  let x = LEFT
  for (const [name, colour] of entries) {
    svg.append(draw('rect', { x, y: 4, width: 14, height: 4, rx: 2, fill: colour }))
    svg.append(draw('text', { x: x + 19, y: 10, class: 'strong' }, name))
    x += 32 + 6.6 * name.length
  }
}

const getEdge = bin => bin < 1 ? 0 : facts.leastError * 10 ** ((bin - 1) / facts.binsADecade)
const showDegrees = v => `${show(v, 2)}\u00b0`

// The decades of error that hold something.
function getErrorRange() {
  let first = Infinity, last = 0
  for (const name of ['assignment', 'lookup'])
    facts[name].forEach((share, bin) => { if (share > 1e-5 && bin > 0) { first = Math.min(first, bin); last = Math.max(last, bin) } })
  if (!last) return null
  const to = Math.min(Math.max(getEdge(last + 1), audit.lookup.max, audit.assignment.max), 200)
  return [Math.min(Math.max(getEdge(first), to / 1e5), to / 10), to]
}

function drawHistogram(range) {
  const none = facts.lookup[0]
  const card = addCard('Lookup errors', none > 0.0005 ? `How many have which error; ${showShare(none)} have none.` : 'How many have which error, on a scale of ratios.')
  const svg = addSvg(card, 'histogram of lookup errors'), group = 3, bars = []
  if (!range) return svg.append(draw('text', { x: WIDTH / 2, y: HEIGHT / 2, 'text-anchor': 'middle' }, 'Every error is zero.'))
  for (let b = 1; b < facts.lookup.length; b += group) bars.push([b, facts.lookup.slice(b, b + group).reduce((s, v) => s + v, 0)])
  const x = makeAxis(range[0], range[1], LEFT, WIDTH - LEFT - RIGHT, true)
  const y = makeAxis(0, Math.max(...bars.map(b => b[1])) * 1.05, HEIGHT - BOTTOM, TOP + BOTTOM - HEIGHT)
  drawAxes(svg, x, y, showDegrees, v => `${show(100 * v, 2)} %`, 'degrees')
  for (const [b, share] of bars) {
    const from = x(Math.max(getEdge(b), range[0])), to = x(Math.min(getEdge(b + group), range[1]))
    if (share > 0 && to > from) svg.append(draw('rect', { x: from + 0.5, y: y(share), width: Math.max(to - from - 1, 0.5), height: HEIGHT - BOTTOM - y(share), fill: '#9bb9de' }))
  }
  drawPercentiles(svg, x, audit.lookup)
}

// A label that would touch another goes up a line.
function drawPercentiles(svg, x, figures) {
  const ends = [-Infinity, -Infinity, -Infinity]
  for (const name of ['p50', 'p95', 'p99']) {
    if (!(figures[name] >= x.from)) continue
    const at = x(figures[name]), middle = Math.min(at, WIDTH - RIGHT - 30), line = ends.findIndex(end => end < middle - 34)
    ends[line] = middle + 34
    svg.append(draw('line', { x1: at, x2: at, y1: TOP - 6, y2: HEIGHT - BOTTOM, stroke: '#1d232b', 'stroke-dasharray': '3 3' }))
    svg.append(draw('text', { x: middle, y: TOP - 10 - 13 * line, 'text-anchor': 'middle', class: 'strong' }, `${name} ${show(figures[name], 2)}\u00b0`))
  }
}

function drawCumulative(range) {
  const card = addCard('Up to which error', 'Share of directions answered at least so well.')
  const svg = addSvg(card, 'cumulative distribution of errors')
  if (!range) return svg.append(draw('text', { x: WIDTH / 2, y: HEIGHT / 2, 'text-anchor': 'middle' }, 'Every error is zero.'))
  const x = makeAxis(range[0], range[1], LEFT, WIDTH - LEFT - RIGHT, true), y = makeAxis(0, 1, HEIGHT - BOTTOM, TOP + BOTTOM - HEIGHT)
  drawAxes(svg, x, y, showDegrees, v => `${Math.round(100 * v)} %`, 'degrees')
  drawKey(svg, [['at texels', orange], ['looked up', blue]])
  for (const [name, colour] of [['assignment', orange], ['lookup', blue]]) {
    const points = []
    let sum = 0
    facts[name].forEach((share, bin) => {
      sum += share
      const edge = Math.min(getEdge(bin + 1), range[1])
      if (getEdge(bin + 1) >= range[0] && getEdge(bin) <= range[1]) points.push([x(edge), y(Math.min(sum, 1))])
    })
    drawLine(svg, points, colour)
    for (const p of ['p50', 'p95', 'p99'])
      if (audit[name][p] >= range[0]) svg.append(draw('circle', { cx: x(audit[name][p]), cy: y(Number(p.slice(1)) / 100), r: 3, fill: colour }))
  }
}

function drawRadius() {
  const card = addCard('Error against radius', 'From the middle of the disc, facing the viewer, to the rim.')
  const svg = addSvg(card, 'assignment error against radius'), rings = facts.rings, found = rings.filter(Boolean)
  const most = Math.max(...found.map(r => r[2]), 0)
  if (!(most > 0)) return svg.append(draw('text', { x: WIDTH / 2, y: HEIGHT / 2, 'text-anchor': 'middle' }, 'Every error is zero.'))
  const least = Math.min(...found.map(r => r[0]).filter(v => v > 0), most)
  const x = makeAxis(0, 1, LEFT, WIDTH - LEFT - RIGHT), y = makeAxis(Math.max(least / 1.5, most / 1e4), Math.max(most * 1.1, least * 2), HEIGHT - BOTTOM, TOP + BOTTOM - HEIGHT, true)
  drawAxes(svg, x, y, v => show(v), showDegrees, 'radius of the guide value')
  drawKey(svg, [['half', '#9bb9de'], ['95 %', blue], ['worst', '#1d232b']])
  for (const [k, colour] of [[2, '#1d232b'], [1, blue], [0, '#9bb9de']])
    drawLine(svg, found.length > 1 ? rings.flatMap((ring, r) => ring ? [[x((r + 0.5) / rings.length), y(ring[k])]] : []) : [], colour, k === 2 ? { 'stroke-width': 1.2 } : {})
  /* One ring makes no line. */
  if (found.length === 1) svg.append(draw('circle', { cx: x((rings.indexOf(found[0]) + 0.5) / rings.length), cy: y(most), r: 3, fill: '#1d232b' }))
}

function drawUsage() {
  const card = addCard('How often guide pixels are used', 'Number of texels that name a pixel.')
  const svg = addSvg(card, 'usage of the guide\u2019s pixels'), entries = ['0', '1', '2-7', '8-19', '20+'].map(k => [k, audit.usage[k]])
  const all = entries.reduce((sum, e) => sum + e[1], 0)
  entries.forEach(([name, count], k) => {
    const y = 14 + k * 42, width = (WIDTH - 190) * count / Math.max(all, 1)
    svg.append(draw('text', { x: 44, y: y + 17, 'text-anchor': 'end', class: 'strong' }, name.replace('-', '\u2013')))
    svg.append(draw('rect', { x: 52, y, width: Math.max(width, count ? 1 : 0), height: 24, rx: 2, fill: k ? '#9bb9de' : '#d3d8de' }))
    svg.append(draw('text', { x: 58 + width, y: y + 16 }, count ? `${showShare(count / all)} (${showCount(count)})` : '0'))
  })
}

// The disc in nine directions: how much of each is covered, and asked for.
function drawSectors() {
  const card = addCard('Directions', facts.frames ? 'How much of each is covered; below it, the share of the frames\u2019 pixels that ask for it.' : 'How much of each the guide covers.')
  const svg = addSvg(card, 'coverage by direction'), cx = WIDTH / 2, cy = HEIGHT / 2, R = 116
  const colour = s => `rgb(${ramps.plain[Math.round(20 + 130 * s.coverage)]})`
  facts.sectors.forEach((sector, s) => {
    const middle = (s - 1) * Math.PI / 4, from = middle - Math.PI / 8, to = middle + Math.PI / 8, p = (r, a) => `${(cx + r * Math.cos(a)).toFixed(1)} ${(cy - r * Math.sin(a)).toFixed(1)}`
    const missing = sector.coverage < 0.5
    const style = { fill: colour(sector), stroke: '#fff', 'stroke-width': 2 }
    svg.append(s ? draw('path', { d: `M${p(R / 2, from)}L${p(R, from)}A${R} ${R} 0 0 0 ${p(R, to)}L${p(R / 2, to)}A${R / 2} ${R / 2} 0 0 1 ${p(R / 2, from)}Z`, ...style })
      : draw('circle', { cx, cy, r: R / 2 - 1, ...style }))
    const at = s ? [cx + 0.76 * R * Math.cos(middle), cy - 0.76 * R * Math.sin(middle)] : [cx, cy]
    const ink = sector.coverage > 0.55 ? '#fff' : '#1d232b'
    svg.append(draw('text', { x: at[0], y: at[1] + (facts.frames ? -1 : 4), 'text-anchor': 'middle', style: `fill:${ink};font-weight:600` }, `${missing ? '\u26a0 ' : ''}${Math.round(100 * sector.coverage)} %`))
    if (facts.frames) svg.append(draw('text', { x: at[0], y: at[1] + 12, 'text-anchor': 'middle', style: `fill:${ink};font-size:10.5px` }, `${show(100 * sector.demand, 2)} %`))
  })
}

function fillEncodings() {
  const card = addCard('How to store it', 'Error at the texels once the table went through a file of that kind.')
  const table = card.appendChild(make('table')), head = table.appendChild(make('tr'))
  for (const name of ['encoding', 'mean', 'p99', 'pixels moved']) head.append(make('th', {}, name))
  for (const encoding of facts.encodings) {
    const row = table.appendChild(make('tr'))
    for (const text of [encoding.name, `${show(encoding.mean)}\u00b0`, `${show(encoding.p99)}\u00b0`, showShare(encoding.moved)]) row.append(make('td', {}, text))
  }
}

function drawCharts() {
  const range = getErrorRange()
  drawHistogram(range)
  drawCumulative(range)
  drawRadius()
  drawUsage()
  drawSectors()
  fillEncodings()
}

// ---- the start ---------------------------------------------------------------------------------

// #texel=x,y&map=name&overlay=name opens the page at a place.
function followHash() {
  const wanted = new URLSearchParams(location.hash.slice(1))
  for (const [key, name] of [['map', 'map'], ['overlay', 'overlay']]) {
    const input = [...document.querySelectorAll(`input[name=${name}]`)].find(i => i.value === wanted.get(key))
    if (input) input.click()
  }
  const texel = (wanted.get('texel') || '').split(',').map(Number)
  if (texel.length !== 2 || !texel.every(Number.isInteger)) return
  hold(true)
  moveToTexel(...texel)
}

async function start() {
  fillTiles()
  drawCharts()
  $('audit-text').textContent = $('audit').textContent
  if (typeof DecompressionStream === 'undefined') throw new Error('this browser is too old to unpack the maps')
  state.table = await readGrid('table')
  state.guide = await readGrid('guide')
  state.table.pieces = state.table.pieces.map(Math.round)
  state.crop = measureCrop(state.table, state.guide)
  const cells = state.table.weight.filter(v => !Number.isNaN(v)).length
  state.table.weight = state.table.weight.map(v => v * cells)
  $('guide-map').parentElement.style.width = `min(100%, ${Math.round(340 * state.crop.width / state.crop.height)}px)`
  state.maps = listMaps(state.table)
  for (const map of state.maps) map.unasked = facts.frames && ['error', 'excess', 'weight'].includes(map.id)
  state.map = state.maps[0]
  addChoices()
  addShortcuts()
  listenToPointers()
  listenToKeys()
  paintTable()
  paintGuide()
  moveToTexel(...audit.assignment.at.texel)
  followHash()
  window.addEventListener('hashchange', followHash)
  document.body.dataset.ready = 'yes'
}
start()
