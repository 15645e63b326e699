-- expect: :2: load: not available in scenes
local f = load("\27Lua")
