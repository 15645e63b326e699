-- expect: :2: setmetatable: not available in scenes, which reach no files, no system and no other code
setmetatable({}, { __gc = function() while true do end end })
