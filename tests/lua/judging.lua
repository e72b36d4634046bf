-- What is told and logged: agreement, difference, loss.
local kit = require("flight")
local flight, airborne = kit.flight, kit.airborne

local function near(a, b, tolerance) return math.abs(a - b) <= tolerance end

local DIFFER = "2 IRH: differ 20 deg: IR +0/+0 EKF +20/+0"
local AGAIN = "5 IRH: horizon and EKF agree again"
local scenarios = {}

function scenarios.agree()
    local f = airborne()
    f.roll, f.pitch = 12.5, -4
    f:ekf(15, -3)
    f:fly(60)
    f:says()
    local entry = f:last()
    assert(near(entry.R, 12.5, 1e-3) and near(entry.P, -4, 1e-3) and near(entry.Q, 0.9, 1e-6))
    assert(near(entry.ER, 15, 1e-3) and near(entry.EP, -3, 1e-3) and entry.S == 4)
    assert(near(entry.D, 2.685, 0.01) and entry.Age < 0.1, entry.D)
end

function scenarios.log_at_10_hz()
    local f = airborne()
    local before = #f.v.log
    f:fly(20)
    assert(math.abs(#f.v.log - before - 200) <= 2, #f.v.log - before)
end

function scenarios.differ_briefly()
    local f = airborne()
    for _ = 1, 20 do
        f:ekf(20, 0)
        f:fly(2.5)
        f:ekf(5, 0)
        f:fly(0.5)
    end
    f:says()
end

function scenarios.differ_long()
    local f = airborne()
    f:ekf(20, 0)
    f:fly(2.8)
    f:says()
    f:fly(0.4)
    f:says(DIFFER)
    assert(f:last().S == 5)
    f:fly(9.5)
    f:says()
    f:fly(19)
    f:says(DIFFER, DIFFER)
    f:ekf(13, 0) -- between 11.25 and 15: neither
    f:fly(20)
    f:says()
    f:ekf(10, 0)
    f:fly(2.5)
    f:says()
    f:fly(1)
    f:says(AGAIN)
    f:fly(30)
    f:says()
end

function scenarios.limits_are_parameters()
    local f = airborne()
    f.v.parameters.IRH_DIFF, f.v.parameters.IRH_TIME = 25, 10
    f:ekf(20, 0)
    f:fly(30)
    f:says()
    f.v.parameters.IRH_DIFF = 5
    f:fly(9.5)
    f:says()
    f:fly(1)
    f:says(DIFFER)
    f.v.parameters.IRH_ENABLE = 0
    local before = #f.v.log
    f:fly(30)
    f:says()
    assert(#f.v.log == before)
    f.v.parameters.IRH_ENABLE, f.v.parameters.IRH_QUAL = 1, 0.95
    f:fly(12)
    f:says("6 IRH: horizon too poor to compare")
end

function scenarios.no_wrap_error()
    local f = airborne()
    f.roll = 179
    f:ekf(-179, 0)
    f:fly(10)
    f.roll, f.pitch = 0, 89
    f:ekf(90, 88) -- straight up: rolls mean nothing
    f:fly(10)
    f.roll, f.pitch = 180, 60
    f:ekf(0, 110) -- no Euler angles that an EKF gives, but the same vertical within 10 degrees
    f:fly(10)
    f:says()
    f.roll, f.pitch = 0, 0
    f:ekf(180, 0)
    f:fly(3.5)
    f:says("2 IRH: differ 180 deg: IR +0/+0 EKF +180/+0")
end

function scenarios.feed_lost()
    local f = airborne()
    f.feeding = false
    f:fly(2.4)
    f:says("4 IRH: horizon withheld")
    f:fly(20)
    f:says("4 IRH: horizon feed lost")
    local entry = f:last()
    assert(entry.S == 1 and entry.R ~= entry.R and near(entry.Age, 22.4, 0.2) and entry.ER == 0)
    f.feeding = true
    f:fly(3)
    f:says("6 IRH: horizon feed good")
end

function scenarios.withheld_by_quality()
    local f = airborne()
    f:ekf(40, 0)
    f.quality = 0
    f:fly(30)
    f:says("4 IRH: horizon withheld")
    f:ekf(0, 0)
    f.quality = 0.9
    f:fly(5)
    f:says("6 IRH: horizon feed good")
end

function scenarios.withheld_though_sent()
    local f = airborne()
    f.v.parameters.IRH_QUAL = 0
    f.quality, f.regardless = 0, true
    f:fly(1)
    f:ekf(40, 0)
    f:fly(30)
    f:says("4 IRH: horizon withheld")
end

function scenarios.withheld_by_status()
    -- As with on-fault = "level": ATTITUDE goes on, and means nothing.
    local f = airborne()
    f:fly(1)
    f.status = 5
    f:fly(1)
    f:ekf(40, 0)
    f:fly(30)
    f:says("4 IRH: horizon withheld")
end

function scenarios.poor_quality()
    local f = airborne()
    f.quality = 0.2
    f:fly(1)
    f:ekf(40, 0)
    f:fly(30)
    f:says("6 IRH: horizon too poor to compare")
    assert(f:last().S == 3 and near(f:last().D, 40, 0.01))
end

function scenarios.difference_outlives_a_gap()
    local f = airborne()
    f:ekf(20, 0)
    f:fly(3.5)
    f:says(DIFFER)
    f.feeding = false
    f:fly(30)
    f:says("4 IRH: horizon withheld", "4 IRH: horizon feed lost")
    f.feeding = true
    f:ekf(2, 0)
    f:fly(10)
    f:says("6 IRH: horizon feed good", AGAIN)
end

function scenarios.flicker_is_not_told_without_end()
    local f = airborne()
    for _ = 1, 60 do
        f.feeding = not f.feeding
        f:fly(2.5)
    end
    assert(f:texts() <= 2 * (150 / 10 + 1), f:texts())
end

function scenarios.on_the_ground()
    local f = flight()
    f.v.armed, f.v.flying = false, false
    f:ekf(40, 0)
    f:fly(30)
    f.v.armed = true -- on the runway
    f:fly(30)
    f:says("6 IRH: monitor started", "6 IRH: horizon feed good")
    f.v.flying = true
    f:fly(2.5)
    f:says()
    f:fly(1)
    f:says("2 IRH: differ 40 deg: IR +0/+0 EKF +40/+0")
    f.v.armed, f.v.flying = false, false
    f:fly(20)
    f.feeding = false
    f:fly(20)
    f:says("6 IRH: horizon withheld", "6 IRH: horizon feed lost")
    f.feeding = true
    f:ekf(0, 0)
    f.v.armed, f.v.flying = true, true -- a new flight knows nothing of the difference in the last
    f:fly(20)
    f:says("6 IRH: horizon feed good")
end

function scenarios.nothing_heard()
    local f = flight()
    f.feeding = false
    f:fly(120)
    f:says("6 IRH: monitor started", "6 IRH: nothing heard of the horizon yet")
    assert(#f.v.log == 0)
    f.feeding = true
    f:fly(5)
    f:says("6 IRH: horizon feed good")
end

return scenarios
