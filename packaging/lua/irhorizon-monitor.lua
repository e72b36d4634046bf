-- irhorizon-monitor: watches ArduPilot's own attitude against that of the infrared horizon.
--
-- irhorizond sends ATTITUDE, NAMED_VALUE_FLOAT ir_qual and HEARTBEAT as component 191. This script
-- takes them in, logs both attitudes side by side ten times a second (message IRHZ) and, in flight,
-- tells the pilot when the two verticals part for longer than a moment, when they agree again, and
-- when the feed is lost or withheld. It steers nothing. ArduPilot 4.5 or later; see docs/mavlink.md.
--
-- ArduPilot's Lua has 32-bit integers and floats; times are its uint32_t, which wraps.

local SEVERITY = { CRITICAL = 2, ERROR = 3, WARNING = 4, NOTICE = 5, INFO = 6 }

-- The key of the parameter table must be nobody else's on this vehicle.
local TABLE_KEY = 181
local PREFIX = "IRH_"
local PARAMETERS = {
    { "ENABLE", 1 },   -- 0: off, 1: on
    { "SYSID", 0 },    -- system id of the feed, 0: any
    { "COMPID", 191 }, -- component id of the feed
    { "DIFF", 15 },    -- angle between the two verticals that is too large, deg
    { "TIME", 3 },     -- for how long, s
    { "QUAL", 0.3 },   -- quality of the horizon below which nothing is compared, 0 to 1
}

-- What is listened to: length of the whole payload and CRC_EXTRA (common.xml).
local HEARTBEAT, ATTITUDE, VALUE = 0, 30, 251
local MESSAGES = {
    [HEARTBEAT] = { 9, 50 },
    [ATTITUDE] = { 28, 39 },
    [VALUE] = { 18, 170 },
}
local MAV_STATE_ACTIVE = 4

local RUN_MS = 25         -- between two looks at what has arrived
local TAKEN, CHECKED = 20, 6 -- messages a run: taken from the queue, and of the feed; SCR_VM_I_COUNT is 10000
local LOG_MS = 100
local ATTITUDE_S = 1.0    -- an attitude older than this is withheld
local FEED_S = 3.5        -- without heartbeat and attitude for so long the feed is lost
local SETTLED_S = 1.0     -- a state of the feed that lasts so long is told
local REPEAT_S = 10.0     -- between two texts of one sort
local PATIENCE_S = 30.0   -- before the script says that it has heard nothing at all
local AGAIN = 0.75        -- of DIFF: below it the two agree again

-- States, as logged.
local SILENT, LOST, WITHHELD, POOR, AGREE, DIFFER = 0, 1, 2, 3, 4, 5
local TEXTS = {
    [SILENT] = "IRH: nothing heard of the horizon yet",
    [LOST] = "IRH: horizon feed lost",
    [WITHHELD] = "IRH: horizon withheld",
    [POOR] = "IRH: horizon too poor to compare",
    [AGREE] = "IRH: horizon feed good",
}

local NAN = 0 / 0
local parameters = {} -- by name
local feed = {}       -- roll, pitch (rad), quality, status, and when: attitude_ms, quality_ms, beat_ms
local told = { feed = SILENT }
local alarm = false   -- a difference was told and not yet called off
local state, state_ms, start_ms, log_ms
local differs_ms, agrees_ms, in_flight
local ready = false

local byte, unpack = string.byte, string.unpack

local function seconds(now, since)
    return (now - since):tofloat() * 0.001
end

-- Whether something last done at `since` is at least `span` seconds ago, or was never done.
local function passed(now, since, span)
    return since == nil or seconds(now, since) >= span
end

local function is_angle(x)
    return type(x) == "number" and x > -10 and x < 10
end

local function crc(sum, bytes, first, last)
    for i = first, last do
        local b = byte(bytes, i) ~ (sum & 0xff)
        b = (b ~ (b << 4)) & 0xff
        sum = (sum >> 8) ~ (b << 8) ~ (b << 3) ~ (b >> 4)
    end
    return sum & 0xffff
end

-- The message id and the payload, at its full length, of a message of the feed; nil for any other
-- and for a damaged one: ArduPilot hands scripts messages with a wrong checksum too. What it hands
-- over is not the frame but its structure: 291 bytes, or 299 where system ids have four bytes.
local function open(bytes)
    local wide = #bytes >= 299
    if #bytes < 291 then return nil end
    local sum, magic, length, incompatible = unpack("<HBBB", bytes, 1)
    local system, component, id
    if wide then
        system, component, id = unpack("<I4BI3", bytes, 8)
    else
        system, component, id = unpack("<BBI3", bytes, 8)
    end
    local message = MESSAGES[id]
    if message == nil or component ~= parameters.COMPID:get() then return nil end
    local wanted = parameters.SYSID:get()
    if wanted ~= 0 and system ~= wanted then return nil end

    local first = wide and 16 or 13
    local last = first + length - 1
    local found
    if magic == 0xfd then
        local long = wide and incompatible & 2 ~= 0
        found = crc(0xffff, bytes, 4, long and 11 or 8)
        found = crc(found, bytes, first - 4, first - 1)
        if wide and incompatible & 4 ~= 0 then found = crc(found, bytes, 295, 299) end
    elseif magic == 0xfe then
        local seq = byte(bytes, 7)
        found = crc(0xffff, string.char(length, seq, system & 0xff, component, id & 0xff), 1, 5)
    else
        return id, nil
    end
    found = crc(found, bytes, first, last)
    found = crc(found, string.char(message[2]), 1, 1)
    if found ~= sum then return id, nil end
    -- The zeros at the end are not sent.
    local payload = string.sub(bytes, first, math.min(last, first + message[1] - 1))
    return id, payload .. string.rep("\0", message[1] - #payload)
end

local function hear(id, payload, at)
    if id == ATTITUDE then
        local roll, pitch = unpack("<ff", payload, 5)
        if is_angle(roll) and is_angle(pitch) then
            feed.roll, feed.pitch, feed.attitude_ms = roll, pitch, at
        end
    elseif id == HEARTBEAT then
        feed.status, feed.beat_ms = byte(payload, 8), at
    elseif string.sub(payload, 9, 18) == "ir_qual\0\0\0" then
        local quality = unpack("<f", payload, 5)
        if quality >= 0 and quality <= 1 then
            feed.quality, feed.quality_ms = quality, at
        end
    end
end

local function receive()
    local checked = 0
    for _ = 1, TAKEN do
        local bytes, _, at = mavlink:receive_chan()
        if bytes == nil then return end
        local id, payload = open(bytes)
        if payload ~= nil then hear(id, payload, at) end
        if id ~= nil then checked = checked + 1 end
        if checked >= CHECKED then return end
    end
end

-- Roll and pitch as ArduPilot has them, rad; the names changed after 4.6.
local function own_attitude()
    local roll, pitch
    if ahrs.get_roll_rad ~= nil then
        roll, pitch = ahrs:get_roll_rad(), ahrs:get_pitch_rad()
    else
        roll, pitch = ahrs:get_roll(), ahrs:get_pitch()
    end
    if not is_angle(roll) or not is_angle(pitch) then return nil, nil end
    return roll, pitch
end

-- The angle between the verticals of two attitudes, deg: nothing wraps, and roll counts for as much
-- as it does at that pitch.
local function apart(roll_a, pitch_a, roll_b, pitch_b)
    local c = math.sin(pitch_a) * math.sin(pitch_b)
        + math.cos(pitch_a) * math.cos(pitch_b) * math.cos(roll_a - roll_b)
    return math.deg(math.acos(math.max(-1, math.min(1, c))))
end

local function feed_state(now)
    local attitude_old = passed(now, feed.attitude_ms, ATTITUDE_S)
    local beat_old = passed(now, feed.beat_ms, FEED_S)
    if feed.attitude_ms == nil and feed.beat_ms == nil then return SILENT end
    if beat_old and passed(now, feed.attitude_ms, FEED_S) then return LOST end
    if attitude_old or (not beat_old and feed.status ~= MAV_STATE_ACTIVE) then return WITHHELD end
    if passed(now, feed.quality_ms, FEED_S) then return POOR end
    if feed.quality <= 0 then return WITHHELD end
    if feed.quality < parameters.QUAL:get() then return POOR end
    return AGREE
end

-- Says how the feed is once that has lasted, and not more often than every REPEAT_S.
local function tell_feed(now, found, flying)
    if found ~= state then
        state, state_ms = found, now
    end
    local settled = found == LOST or seconds(now, state_ms) >= SETTLED_S
    local due = found ~= told.feed and settled
    if found == SILENT then
        due = not told.silent and passed(now, start_ms, PATIENCE_S)
        told.silent = told.silent or due
    end
    -- Bad news waits for bad news only.
    local bad = found == LOST or found == WITHHELD
    local before = told.feed_ms
    if bad then before = told.bad_ms end
    if not due or not passed(now, before, REPEAT_S) then return end
    gcs:send_text(flying and bad and SEVERITY.WARNING or SEVERITY.INFO, TEXTS[found])
    told.feed, told.feed_ms = found, now
    if bad then told.bad_ms = now end
end

-- Warns of a difference that lasts, and calls it off. DIFFER while it is too large.
local function judge(now, angle, roll, pitch)
    local limit = math.max(1, parameters.DIFF:get())
    local span = math.max(0, parameters.TIME:get())
    if angle > limit then
        agrees_ms, differs_ms = nil, differs_ms or now
        if passed(now, differs_ms, span) and (not alarm or passed(now, told.differ_ms, REPEAT_S)) then
            alarm, told.differ_ms = true, now
            local d = math.deg
            gcs:send_text(SEVERITY.CRITICAL, string.format("IRH: differ %.0f deg: IR %+.0f/%+.0f EKF %+.0f/%+.0f",
                angle, d(feed.roll), d(feed.pitch), d(roll), d(pitch)))
        end
        return DIFFER
    end
    differs_ms = nil
    if angle > limit * AGAIN then
        agrees_ms = nil
    elseif alarm then
        agrees_ms = agrees_ms or now
        if passed(now, agrees_ms, span) then
            alarm = false
            gcs:send_text(SEVERITY.NOTICE, "IRH: horizon and EKF agree again")
        end
    end
    return AGREE
end

local function look(now)
    -- On the ground the head sees hangars and people; nothing is compared there.
    local flying = arming:is_armed() and vehicle:get_likely_flying()
    if in_flight and not flying then alarm = false end
    in_flight = flying
    local found = feed_state(now)
    tell_feed(now, found, flying)
    if feed.attitude_ms == nil then return end

    local roll, pitch = own_attitude()
    local fresh = not passed(now, feed.attitude_ms, ATTITUDE_S)
    local angle = fresh and roll ~= nil and apart(feed.roll, feed.pitch, roll, pitch) or NAN
    if found == AGREE and flying and angle == angle then
        found = judge(now, angle, roll, pitch)
    else
        differs_ms, agrees_ms = nil, nil
    end
    local d = math.deg
    logger:write("IRHZ", "R,P,Q,ER,EP,D,Age,S", "fffffffB", "dd-ddds-", "0000000-",
        fresh and d(feed.roll) or NAN, fresh and d(feed.pitch) or NAN, feed.quality or NAN,
        roll and d(roll) or NAN, pitch and d(pitch) or NAN, angle, seconds(now, feed.attitude_ms), found)
end

local function setup()
    assert(param:add_table(TABLE_KEY, PREFIX, #PARAMETERS), "parameter table " .. TABLE_KEY .. " is in use")
    for i, p in ipairs(PARAMETERS) do
        assert(param:add_param(TABLE_KEY, i, p[1], p[2]), "no parameter " .. PREFIX .. p[1])
        parameters[p[1]] = Parameter(PREFIX .. p[1])
    end
    -- Does nothing where another script was first; all scripts share one queue.
    mavlink:init(20, 8)
    for id in pairs(MESSAGES) do
        mavlink:register_rx_msgid(id)
    end
    start_ms, log_ms = millis(), millis()
    gcs:send_text(SEVERITY.INFO, "IRH: monitor started")
    ready = true
end

local function update()
    if not ready then setup() end
    receive()
    local now = millis()
    if parameters.ENABLE:get() < 1 or (now - log_ms):toint() < LOG_MS then return end
    log_ms = now
    look(now)
end

-- An error does not end the script: it is told, and all goes on a second later.
local function run()
    local good, problem = pcall(update)
    if good then return run, RUN_MS end
    pcall(function()
        local now = millis()
        if passed(now, told.error_ms, REPEAT_S) then
            told.error_ms = now
            gcs:send_text(SEVERITY.ERROR, "IRH: " .. string.sub(tostring(problem), -44))
        end
    end)
    return run, 1000
end

return run()
