// Serves webgl.html and what it asks for, opens it in headless Chromium and prints what browse.mjs says of it:
//   node webgl.mjs BUILD MODULES BUNDLE FRAME ANGLE [OPTION OF browse.mjs...]
// FRAME is what draw_frame wrote; ANGLE is how Chromium draws: gl-egl (Mesa) or swiftshader.
import { spawn } from 'node:child_process'
import { readFile } from 'node:fs/promises'
import { createServer } from 'node:http'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'

const [build, modules, bundle, frame, angle, ...options] = process.argv.slice(2)
const here = dirname(fileURLToPath(import.meta.url))
const types = { html: 'text/html', js: 'text/javascript' }
const folders = { bundle, frame, glsl: join(build, 'glsl') }

function find(path) {
  const [, folder, ...rest] = path.split('/')
  if (path === '/ktx-parse.js') return join(modules, 'ktx-parse/dist/ktx-parse.modern.js')
  return folders[folder] ? join(folders[folder], ...rest) : join(here, 'webgl.html')
}

const server = createServer(async (request, response) => {
  const file = find(request.url)
  const bytes = await readFile(file).catch(() => null)
  response.writeHead(bytes ? 200 : 404, { 'content-type': types[file.split('.').pop()] || 'application/octet-stream' })
  response.end(bytes)
})
server.listen(0, '127.0.0.1', () => {
  const flags = `--use-gl=angle --use-angle=${angle} --ignore-gpu-blocklist --enable-unsafe-swiftshader`
  const browser = spawn(process.execPath, [join(here, '../cli/browse.mjs'), `http://127.0.0.1:${server.address().port}/page`,
    '--graphics', flags, '--eval', 'window.outcome', ...options], { stdio: ['ignore', 'inherit', 'inherit'] })
  browser.on('exit', code => {
    process.exitCode = code
    server.close()
    server.closeAllConnections()
  })
})
