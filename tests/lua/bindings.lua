-- ArduPilot's Lua bindings as far as the monitor may use them, faked strictly: a binding that does
-- not exist is nil, and wrong arguments, a dot in place of a colon, numbers that do not fit 32 bits or
-- texts that are too long are errors. Signatures are those of AP_Scripting/docs/docs.lua.
local bindings = {}

local U32 = 0x100000000
local uint32 = { __name = "uint32_t" }
uint32.__index = uint32

local function number_of(x)
    if getmetatable(x) == uint32 then return x.value end
    assert(type(x) == "number" and x >= 0 and x < U32, "no uint32_t: " .. tostring(x))
    return math.floor(x)
end

local function new(value)
    return setmetatable({ value = value % U32 }, uint32)
end

uint32.__sub = function(a, b) return new(number_of(a) - number_of(b)) end
uint32.__add = function(a, b) return new(number_of(a) + number_of(b)) end
uint32.__lt = function(a, b) return number_of(a) < number_of(b) end
uint32.__le = function(a, b) return number_of(a) <= number_of(b) end
uint32.__eq = function(a, b) return number_of(a) == number_of(b) end
function uint32:toint() return self.value >= 0x80000000 and self.value - U32 or self.value end
-- A float of 32 bits.
function uint32:tofloat() return (string.unpack("<f", string.pack("<f", self.value))) end

local checks = {
    integer = function(x) return math.type(x) == "integer" and x >= -0x80000000 and x < 0x80000000 end,
    number = function(x) return type(x) == "number" end,
    string = function(x) return type(x) == "string" end,
}

-- A binding called with a colon on `owner`, with arguments of these types.
local function method(owner, name, types, body)
    owner[name] = function(self, ...)
        assert(self == owner, name .. ": called without a colon")
        assert(select("#", ...) == #types, name .. ": takes " .. #types .. " arguments")
        for i, wanted in ipairs(types) do
            local got = select(i, ...)
            assert(checks[wanted](got), string.format("%s: argument %d is no %s: %s", name, i, wanted, tostring(got)))
        end
        if bindings.fault == name then error(name .. ": told to fail") end
        return body(...)
    end
end

-- AP_Logger's README has the letters.
local function each_of(text, letters)
    for letter in string.gmatch(text, ".") do
        assert(string.find(letters, letter, 1, true), letter .. " is no unit or multiplier")
    end
end

-- A vehicle just switched on, `generation` "4.5" (get_roll), "4.6" (both) or "later" (get_roll_rad).
-- Its parameters and the queue of messages outlive a restart of the scripts.
function bindings.vehicle(generation)
    local v = {
        ms = 5000, armed = true, flying = true, roll = 0, pitch = 0,
        texts = {}, log = {}, parameters = {}, tables = {}, queue = {}, registered = {},
    }
    local env = {
        assert = assert, error = error, ipairs = ipairs, pairs = pairs, pcall = pcall, select = select,
        tostring = tostring, tonumber = tonumber, type = type, math = math, string = string, table = table,
    }
    bindings.fault = nil

    env.millis = function(...)
        assert(select("#", ...) == 0)
        if bindings.fault == "millis" then error("millis: told to fail") end
        return new(v.ms)
    end
    env.uint32_t = new

    env.gcs = {}
    method(env.gcs, "send_text", { "integer", "string" }, function(severity, text)
        assert(severity >= 0 and severity <= 7 and #text <= 50, text)
        v.texts[#v.texts + 1] = { ms = v.ms, severity = severity, text = text }
    end)

    env.param = {}
    method(env.param, "add_table", { "integer", "string", "integer" }, function(key, prefix, count)
        assert(key >= 0 and key <= 200 and count <= 63)
        if v.tables[key] ~= nil and v.tables[key] ~= prefix then return false end
        v.tables[key] = prefix
        return true
    end)
    method(env.param, "add_param", { "integer", "integer", "string", "number" }, function(key, index, name, default)
        local whole = v.tables[key] .. name
        assert(index >= 1 and #whole <= 16, whole)
        if v.parameters[whole] == nil then v.parameters[whole] = default end
        return true
    end)
    env.Parameter = function(name)
        assert(v.parameters[name] ~= nil, "no parameter " .. tostring(name))
        local parameter = {}
        method(parameter, "get", {}, function() return v.parameters[name] + 0.0 end)
        return parameter
    end

    env.mavlink = {}
    method(env.mavlink, "init", { "integer", "integer" }, function(depth, ids)
        assert(depth >= 0 and depth <= 25 and ids >= 0 and ids <= 25)
        -- What another script, or this one before a restart, has asked for stays.
        v.depth, v.ids = v.depth or depth, v.ids or ids
    end)
    method(env.mavlink, "register_rx_msgid", { "integer" }, function(id)
        if v.registered[id] then return false end
        local count = 0
        for _ in pairs(v.registered) do count = count + 1 end
        assert(count < v.ids, "no registrations free")
        v.registered[id] = true
        return true
    end)
    method(env.mavlink, "receive_chan", {}, function()
        assert(v.depth, "RX not initialized")
        local message = table.remove(v.queue, 1)
        if message ~= nil then return message.bytes, 0, new(message.ms) end
    end)

    env.ahrs = {}
    if generation ~= "later" then
        method(env.ahrs, "get_roll", {}, function() return v.roll end)
        method(env.ahrs, "get_pitch", {}, function() return v.pitch end)
    end
    if generation ~= "4.5" then
        method(env.ahrs, "get_roll_rad", {}, function() return v.roll end)
        method(env.ahrs, "get_pitch_rad", {}, function() return v.pitch end)
    end
    env.arming, env.vehicle = {}, {}
    method(env.arming, "is_armed", {}, function() return v.armed end)
    method(env.vehicle, "get_likely_flying", {}, function() return v.flying end)

    env.logger = {}
    env.logger.write = function(self, name, labels, format, units, multipliers, ...)
        assert(self == env.logger, "write: called without a colon")
        if bindings.fault == "write" then error("write: told to fail") end
        local values, entry = table.pack(...), { ms = v.ms }
        local names = {}
        for label in string.gmatch(labels, "[^,]+") do names[#names + 1] = label end
        assert(#name <= 4 and #labels <= 56 and #format <= 14, "too long for the log")
        assert(#names == #format and #units == #format and #multipliers == #format and values.n == #format)
        each_of(units, "-?AbBdkDeEGhiJlLmnNoO%SsqrUuvPwWXYz#")
        each_of(multipliers, "-?210ABCDEFGI!/")
        for i = 1, #format do
            local kind, value = string.sub(format, i, i), values[i]
            assert(type(value) == "number", names[i])
            if kind == "B" then assert(math.type(value) == "integer" and value >= 0 and value <= 255, names[i])
            else assert(kind == "f", kind) end
            entry[names[i]] = value
        end
        v.log[#v.log + 1] = entry
    end

    -- A frame's structure arrives: taken only if a script wants it and there is room.
    function v.arrive(id, bytes)
        if v.depth and v.registered[id] and #v.queue < v.depth then
            v.queue[#v.queue + 1] = { bytes = bytes, ms = v.ms }
        end
    end
    v.env = env
    return v
end

return bindings
