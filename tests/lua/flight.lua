-- A vehicle that flies with the monitor on it and a feed of the horizon, by faked time.
local folder = string.match(arg[0], "^(.*)/[^/]*$") or "."
local bindings, frames = require("bindings"), require("frames")
local SCRIPT = folder .. "/../../packaging/lua/irhorizon-monitor.lua"

-- ArduPilot ends a script that takes more instructions than this in one run (SCR_VM_I_COUNT).
local INSTRUCTIONS = 10000

local Flight = {}
Flight.__index = Flight

-- A vehicle with the script running; it has not run for the first time yet.
local function flight(options)
    local f = setmetatable({ v = bindings.vehicle(options and options.generation or "4.6") }, Flight)
    f.v.ms = options and options.ms or f.v.ms
    f.wide = options and options.wide
    f.version = options and options.version or 2
    f.hz, f.quality, f.status, f.roll, f.pitch = 50, 0.9, 4, 0, 0
    f.system, f.component, f.feeding = 1, 191, true
    f:restart()
    return f
end

function Flight:restart()
    self.step = assert(loadfile(SCRIPT, "t", self.v.env))
    self.due = self.v.ms
end

function Flight:run()
    debug.sethook(function() error("more than " .. INSTRUCTIONS .. " instructions in one run") end, "", INSTRUCTIONS)
    local step, delay = self.step()
    debug.sethook()
    assert(type(step) == "function" and math.type(delay) == "integer" and delay >= 1, "the script has ended")
    self.step, self.due = step, self.v.ms + delay
end

function Flight:arrive(wire)
    self.v.arrive(frames.structure(wire, self.wide))
end

function Flight:send()
    local v, s, c, version = self.v, self.system, self.component, self.version
    self.sent = (self.sent or 0) + 5
    if self.sent % (1000 // self.hz) == 0 and (self.quality > 0 or self.regardless) then
        self:arrive(frames.attitude(version, s, c, v.ms, self.roll, self.pitch))
    end
    if self.sent % 1000 == 0 then
        self:arrive(frames.heartbeat(version, s, c, self.status))
        self:arrive(frames.value(version, s, c, v.ms, "ir_qual", self.quality))
        self:arrive(frames.value(version, s, c, v.ms, "ir_contr", 21))
    end
end

-- Lets time go by, with the feed if there is one.
function Flight:fly(seconds)
    for _ = 1, seconds * 200 do
        self.v.ms = (self.v.ms + 5) % 0x100000000
        if self.feeding then self:send() end
        local late = (self.v.ms - self.due) % 0x100000000
        if late < 0x80000000 then self:run() end
    end
end

-- The attitude that the EKF has, deg.
function Flight:ekf(roll, pitch)
    self.v.roll, self.v.pitch = math.rad(roll), math.rad(pitch)
end

-- Texts since the last time asked, by a part of what they say.
function Flight:texts(part)
    local count = 0
    for i = (self.read or 0) + 1, #self.v.texts do
        if part == nil or string.find(self.v.texts[i].text, part, 1, true) then count = count + 1 end
    end
    return count
end

-- Checks that these texts, and no others, have come since the last check.
function Flight:says(...)
    local got = {}
    for i = (self.read or 0) + 1, #self.v.texts do
        got[#got + 1] = self.v.texts[i].severity .. " " .. self.v.texts[i].text
    end
    self.read = #self.v.texts
    local wanted = table.concat({ ... }, "\n")
    local all = table.concat(got, "\n")
    assert(all == wanted, "\nsaid\n" .. all .. "\nbut should say\n" .. wanted)
end

-- In the air with a good feed, all that is said so far read.
local function airborne(options)
    local f = flight(options)
    f:fly(5)
    f:says("6 IRH: monitor started", "6 IRH: horizon feed good")
    return f
end

function Flight:last() return self.v.log[#self.v.log] end

return { flight = flight, airborne = airborne }
