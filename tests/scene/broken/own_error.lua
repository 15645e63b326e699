-- expect: :3: no boxes today
local function fail()
  error("no boxes\ntoday")
end
fail()
