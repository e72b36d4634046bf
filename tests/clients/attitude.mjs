// Attitude as node-mavlink shows it. Its arguments and report are those of the Python clients; the
// folder of its packages, which `setup node` prints, comes first.
import { createRequire } from 'node:module'
import { createSocket } from 'node:dgram'
import { PassThrough } from 'node:stream'
import { join } from 'node:path'
import { parseArgs } from 'node:util'

const [folder, ...rest] = process.argv.slice(2)
const require = createRequire(join(folder, 'x.js'))
const { MavLinkPacketSplitter, MavLinkPacketParser } = require('node-mavlink')
const { minimal, common } = require('mavlink-mappings')
const { version } = require('node-mavlink/package.json')

const { values } = parseArgs({
  args: rest,
  options: {
    listen: { type: 'string' },
    seconds: { type: 'string', default: '5' },
    wait: { type: 'string', default: '30' },
    system: { type: 'string', default: '1' },
  },
})
const [host, port] = values.listen.split(':')
const REGISTRY = { ...minimal.REGISTRY, ...common.REGISTRY }
const degrees = (x) => (x * 180) / Math.PI
const attitude = []
const counts = {}
let damaged = 0

function end() {
  console.log(JSON.stringify({ attitude, version, counts, damaged }))
  process.exit(attitude.length > 0 ? 0 : 1)
}

const bytes = new PassThrough()
const packets = bytes.pipe(new MavLinkPacketSplitter({}, { onCrcError: () => damaged++ })).pipe(new MavLinkPacketParser())
let timer = setTimeout(end, Number(values.wait) * 1000)
packets.on('data', (packet) => {
  const { msgid, sysid } = packet.header
  const type = REGISTRY[msgid]
  if (sysid !== Number(values.system) || type === undefined) return
  const message = packet.protocol.data(packet.payload, type)
  counts[type.MSG_NAME] = (counts[type.MSG_NAME] ?? 0) + 1
  if (msgid !== common.Attitude.MSG_ID) return
  if (attitude.length === 0) {
    clearTimeout(timer)
    timer = setTimeout(end, Number(values.seconds) * 1000)
  }
  const { roll, pitch, rollspeed, pitchspeed, yawspeed } = message
  attitude.push([message.timeBootMs, ...[roll, pitch, rollspeed, pitchspeed, yawspeed].map(degrees)])
})
const socket = createSocket('udp4')
socket.on('message', (datagram) => bytes.write(datagram))
socket.bind(Number(port), host, () => console.error('listening'))
