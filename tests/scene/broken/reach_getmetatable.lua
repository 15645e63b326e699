-- expect: :2: getmetatable: not available in scenes, which reach no files, no system and no other code
getmetatable("").__index = nil
