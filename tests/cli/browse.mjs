// Opens a page in headless Chromium and says what happened, as JSON on stdout:
//   node browse.mjs PAGE[#hash] [--eval EXPRESSION] [--shot FILE.png] [--size WIDTHxHEIGHT] [--full] [--graphics FLAGS]
// PAGE is a file or an address; FLAGS say how Chromium draws.
// {"ready", "errors": [...], "requests": [...], "value"}; requests are all but the
// page itself and data: addresses. The protocol goes through a pipe, so that
// nothing beyond node and chromium is needed.
import { spawn } from 'node:child_process'
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join, resolve } from 'node:path'
import { pathToFileURL } from 'node:url'

const options = {}, places = []
for (let i = 2; i < process.argv.length; i++) {
  const argument = process.argv[i]
  if (argument === '--full') options.full = true
  else if (argument.startsWith('--')) options[argument.slice(2)] = process.argv[++i]
  else places.push(argument)
}
const [width, height] = (options.size || '1280x800').split('x').map(Number)
const [path, hash] = places[0].split(/#(.*)/s)
const address = path.startsWith('http:') ? path : pathToFileURL(resolve(path)).href

const profile = mkdtempSync(join(tmpdir(), 'browse-'))
// Run as root, as in containers, Chromium refuses its sandbox; the page is ours.
const browser = spawn(process.env.CHROMIUM || 'chromium',
  ['--headless', '--no-sandbox', ...(options.graphics || '--disable-gpu').split(' '), '--hide-scrollbars', '--disable-dev-shm-usage', '--disable-extensions',
    '--disable-background-networking', `--user-data-dir=${profile}`, '--remote-debugging-pipe', 'about:blank'],
  { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], env: { ...process.env, HOME: profile } })
const ended = new Promise(done => browser.on('exit', done))
const [, , , input, output] = browser.stdio

let last = 0, rest = Buffer.alloc(0)
const waiting = new Map(), listeners = []
output.on('data', chunk => {
  rest = Buffer.concat([rest, chunk])
  for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1)) receive(JSON.parse(rest.toString('utf8', 0, end)))
})
function receive(message) {
  if (!message.id) return listeners.forEach(listen => listen(message))
  const { accept, refuse } = waiting.get(message.id)
  waiting.delete(message.id)
  if (message.error) refuse(new Error(message.error.message))
  else accept(message.result)
}
function call(method, params = {}, sessionId) {
  const id = ++last
  input.write(JSON.stringify({ id, method, params, sessionId }) + '\0')
  return new Promise((accept, refuse) => waiting.set(id, { accept, refuse }))
}

async function browse() {
  const { targetId } = await call('Target.createTarget', { url: 'about:blank' })
  const { sessionId } = await call('Target.attachToTarget', { targetId, flatten: true })
  const ask = (method, params) => call(method, params, sessionId)
  const result = { ready: false, errors: [], requests: [] }
  listeners.push(({ method, params }) => {
    if (method === 'Runtime.exceptionThrown') result.errors.push(params.exceptionDetails.exception?.description || params.exceptionDetails.text)
    if (method === 'Runtime.consoleAPICalled') result.errors.push(`console.${params.type}`)
    if (method === 'Log.entryAdded') result.errors.push(params.entry.text)
    if (method === 'Page.javascriptDialogOpening') result.errors.push(`dialog: ${params.message}`)
    if (method === 'Network.requestWillBeSent' && params.request.url.split('#')[0] !== address && !params.request.url.startsWith('data:'))
      result.requests.push(params.request.url)
  })
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await ask(`${domain}.enable`)
  await ask('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false })
  await ask('Page.navigate', { url: address + (hash ? `#${hash}` : '') })
  const evaluate = async expression => {
    const { result: value, exceptionDetails } = await ask('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true })
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description || exceptionDetails.text)
    return value.value
  }
  for (let tries = 0; tries < 300 && !result.ready && !result.errors.length; tries++) {
    await new Promise(done => setTimeout(done, 50))
    result.ready = await evaluate('location.href !== "about:blank" && document.body?.dataset.ready === "yes"').catch(() => false)
  }
  if (options.eval) result.value = await evaluate(options.eval)
  if (options.shot) {
    const size = await evaluate('[document.documentElement.scrollWidth, document.documentElement.scrollHeight]')
    const clip = options.full ? { clip: { x: 0, y: 0, width: size[0], height: size[1], scale: 1 }, captureBeyondViewport: true } : {}
    const { data } = await ask('Page.captureScreenshot', { format: 'png', ...clip })
    writeFileSync(options.shot, Buffer.from(data, 'base64'))
  }
  return result
}

const limit = setTimeout(() => browser.kill('SIGKILL'), 90000)
let code = 0
try {
  console.log(JSON.stringify(await Promise.race([browse(), ended.then(() => { throw new Error('chromium ended') })]), null, 1))
} catch (error) {
  console.error(`browse: ${error.message}`)
  code = 1
}
// Asked to end, it takes its helpers along, which would still write to the folder.
call('Browser.close').catch(() => browser.kill('SIGKILL'))
await ended
clearTimeout(limit)
rmSync(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 })
process.exit(code)
