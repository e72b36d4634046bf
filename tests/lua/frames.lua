-- MAVLink frames as they are on the wire, and as ArduPilot's parser hands them to a script: the
-- memory of its mavlink_message_t, of 291 bytes, or 299 since system ids have four.
local frames = {}

local EXTRA = { [0] = 50, [30] = 39, [251] = 170 }

-- CRC-16/MCRF4XX, bit by bit.
local function crc(bytes)
    local sum = 0xffff
    for i = 1, #bytes do
        sum = sum ~ string.byte(bytes, i)
        for _ = 1, 8 do
            sum = sum & 1 == 1 and (sum >> 1) ~ 0x8408 or sum >> 1
        end
    end
    return sum
end
assert(crc("123456789") == 0x6f91)

local sequence = 0

-- A frame of MAVLink `version` on the wire.
function frames.wire(version, system, component, id, payload)
    sequence = (sequence + 1) % 256
    local head
    if version == 2 then
        payload = string.gsub(payload, "\0+$", "")
        if payload == "" then payload = "\0" end
        head = string.pack("<BBBBBBI3", #payload, 0, 0, sequence, system, component, id)
    else
        head = string.pack("<BBBBB", #payload, sequence, system, component, id)
    end
    local body = head .. payload
    local magic = version == 2 and "\xfd" or "\xfe"
    return magic .. body .. string.pack("<H", crc(body .. string.char(EXTRA[id] or 0)))
end

function frames.attitude(version, system, component, ms, roll_deg, pitch_deg)
    local payload = string.pack("<I4ffffff", ms, math.rad(roll_deg), math.rad(pitch_deg), 0, 0, 0, 0)
    return frames.wire(version, system, component, 30, payload)
end

function frames.heartbeat(version, system, component, status)
    return frames.wire(version, system, component, 0, string.pack("<I4BBBBB", 0, 18, 8, 0, status, 3))
end

function frames.value(version, system, component, ms, name, value)
    return frames.wire(version, system, component, 251, string.pack("<I4fc10", ms, value, name))
end

-- Message id and structure of a frame. What lies behind its payload is what lay there before; a
-- parser may or may not have cleared it.
function frames.structure(wire, wide)
    local magic, length = string.byte(wire, 1, 2)
    local incompatible, compatible, seq, system, component, id, from
    if magic == 0xfd then
        incompatible, compatible, seq, system, component, id, from = string.unpack("<BBBBBI3", wire, 3)
    else
        incompatible, compatible = 0, 0
        seq, system, component, id, from = string.unpack("<BBBB", wire, 3)
    end
    local payload = string.sub(wire, from, from + length - 1)
    local sum, rest = string.unpack("<H", wire, from + length)
    payload = payload .. string.rep("\xa5", 264 - #payload)
    local signature = string.sub(wire, rest, rest + 12)
    local head = string.pack(wide and "<HBBBBBI4BI3" or "<HBBBBBBBI3", sum, magic, length, incompatible, compatible,
        seq, system, component, id)
    local structure = head .. payload .. string.pack("<H", sum) .. signature .. string.rep("\0", 13 - #signature)
    if wide then structure = structure .. string.rep("\0", 5) end
    assert(#structure == (wide and 299 or 291))
    return id, structure
end

return frames
