-- What must not disturb the monitor: damaged frames, other senders, faults, restarts.
local kit = require("flight")
local flight, airborne = kit.flight, kit.airborne
local bindings, frames = require("bindings"), require("frames")

local function near(a, b, tolerance) return math.abs(a - b) <= tolerance end

local DIFFER = "2 IRH: differ 20 deg: IR +0/+0 EKF +20/+0"
local scenarios = {}

function scenarios.other_senders_are_ignored()
    local f = flight()
    f.v.parameters.IRH_SYSID = 42
    f.component, f.system = 1, 42
    f:fly(40)
    f.component, f.system = 191, 1
    f:fly(10)
    f:says("6 IRH: monitor started", "6 IRH: nothing heard of the horizon yet")
    f.system = 42
    f:fly(5)
    f:says("6 IRH: horizon feed good")
    f.v.parameters.IRH_SYSID, f.v.parameters.IRH_COMPID = 0, 158
    f.system, f.component = 7, 158
    f:fly(5)
    f:says()
end

function scenarios.damaged_frames()
    local f = airborne()
    f.feeding = false
    local level = frames.attitude(2, 1, 191, 1, 0, 0)
    -- After a good message, one that must change nothing; what is logged then.
    local function unmoved(structure)
        f.v.ms = f.v.ms + 100
        f:arrive(level)
        f.v.queue[#f.v.queue + 1] = { bytes = structure, ms = f.v.ms }
        f:run()
        local entry = f:last()
        assert(entry.ms == f.v.ms and entry.R == 0 and entry.P == 0 and near(entry.Q, 0.9, 1e-6), entry.R)
    end
    local tilted = frames.attitude(2, 1, 191, 1, 77, 33)
    for i = 1, #tilted do
        for bit = 0, 7 do
            local bad = string.sub(tilted, 1, i - 1) .. string.char(string.byte(tilted, i) ~ (1 << bit))
                .. string.sub(tilted, i + 1)
            unmoved(select(2, frames.structure(bad .. string.rep("\0", 300), false)))
        end
    end
    for _, bytes in ipairs({ "", "\0", string.rep("\xff", 291), string.rep("\0", 299), string.rep("\xfd", 600) }) do
        unmoved(bytes)
    end
    -- Whole frames with what cannot be.
    for _, x in ipairs({ 0 / 0, 1 / 0, -1 / 0, 1e30 }) do
        unmoved(select(2, frames.structure(frames.attitude(2, 1, 191, 1, x, 0))))
        unmoved(select(2, frames.structure(frames.attitude(2, 1, 191, 1, 0, x))))
        unmoved(select(2, frames.structure(frames.value(2, 1, 191, 1, "ir_qual", x))))
    end
end

local function understood(options)
    local f = airborne(options)
    f.roll, f.pitch = 10, 5
    f:ekf(50, 5)
    f:fly(3.5)
    f:says("2 IRH: differ 40 deg: IR +10/+5 EKF +50/+5")
    f.roll, f.pitch = 0.25, 0 -- the zeros at the end are cut to one byte of roll
    f:fly(1)
    assert(near(f:last().R, 0.25, 1e-5) and f:last().P == 0)
end

function scenarios.mavlink_1() understood({ version = 1 }) end
function scenarios.mavlink_1_wide() understood({ version = 1, wide = true }) end
function scenarios.mavlink_2() understood({ version = 2 }) end
function scenarios.mavlink_2_wide() understood({ version = 2, wide = true }) end
function scenarios.api_4_5() understood({ generation = "4.5" }) end
function scenarios.api_later() understood({ generation = "later", wide = true }) end

function scenarios.script_restart()
    local f = airborne()
    f.v.parameters.IRH_DIFF = 25
    f:restart()
    f:fly(5)
    f:says("6 IRH: monitor started", "6 IRH: horizon feed good")
    f:ekf(20, 0)
    f:fly(10)
    f:says()
end

function scenarios.the_clock_wraps()
    local f = airborne({ ms = 0xffffffff // 1000 * 1000 - 10000 })
    f:fly(4)
    f:ekf(20, 0)
    f:fly(30)
    f:says(DIFFER, DIFFER, DIFFER)
    assert(f.v.ms < 30000)
end

function scenarios.a_flood_is_taken_in_portions()
    local f = airborne()
    f.hz = 200
    f.roll = 3
    f:fly(10)
    assert(#f.v.queue <= 10 and near(f:last().R, 3, 1e-3), #f.v.queue)
    f:says()
end

function scenarios.a_fault_in_a_binding_does_not_end_the_script()
    local bound = { "send_text", "receive_chan", "get_roll_rad", "is_armed", "get_likely_flying", "write", "get", "millis" }
    for _, name in ipairs(bound) do
        local f = airborne()
        bindings.fault = name
        f:ekf(20, 0)
        f:fly(25)
        local said = f:texts("told to fail")
        assert(said <= 3 and (said >= 2 or name == "send_text" or name == "millis"), name .. " " .. said)
        bindings.fault = nil
        f:fly(30)
        assert(f:texts("differ 20 deg") >= 2, name)
    end
end

function scenarios.a_fault_at_the_start_is_tried_again()
    for _, name in ipairs({ "add_table", "add_param", "init", "register_rx_msgid", "millis", "send_text" }) do
        local f = flight()
        bindings.fault = name
        f:fly(15)
        assert(f:texts("monitor started") == 0, name)
        bindings.fault = nil
        f:fly(5)
        assert(f:texts("monitor started") == 1 and f:texts("feed good") == 1, name)
    end
    local f = flight()
    f.v.tables[181] = "OTH_"
    f:fly(25)
    assert(f:texts("181 is in use") == 3, f:texts())
end

function scenarios.memory_is_bounded()
    local f = airborne()
    local function used()
        f.v.log, f.v.texts, f.read = {}, {}, 0
        for _ = 1, 20 do collectgarbage() end -- each halves the table of strings at most
        return collectgarbage("count")
    end
    f:fly(20)
    local before = used()
    for i = 1, 40 do
        f.feeding = i % 3 ~= 0
        f:ekf(i % 5 * 10, 0)
        f:fly(10)
    end
    local grown = used() - before
    assert(grown < 4, grown)
end

return scenarios
