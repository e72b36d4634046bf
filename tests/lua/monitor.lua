-- Scenarios of packaging/lua/irhorizon-monitor.lua against faked bindings.
--   lua5.3 tests/lua/monitor.lua SCENARIO      exit status 0 when it holds
--   lua5.3 tests/lua/monitor.lua --list
--   lua5.3 tests/lua/monitor.lua --feed FILE   a frame a line in hexadecimal: says what was understood
local folder = string.match(arg[0], "^(.*)/[^/]*$") or "."
package.path = folder .. "/?.lua"

local scenarios = {}
for _, room in ipairs({ "judging", "robustness" }) do
    for name, scenario in pairs(require(room)) do scenarios[name] = scenario end
end

local function feed(file)
    local f = require("flight").flight()
    f.feeding = false
    f:fly(0.1)
    for line in io.lines(file) do
        local bytes = string.gsub(line, "%x%x", function(h) return string.char(tonumber(h, 16)) end)
        f:arrive(bytes)
        f:fly(0.1)
        local e = f:last() or {}
        print(string.format("%.4f %.4f %.4f %d", e.R or 0 / 0, e.P or 0 / 0, e.Q or 0 / 0, e.S or 0))
    end
end

if arg[1] == "--list" then
    for name in pairs(scenarios) do print(name) end
elseif arg[1] == "--feed" then
    feed(arg[2])
else
    assert(scenarios[arg[1]], "no such scenario")()
end
