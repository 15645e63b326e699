-- expect: :2: pcall: not available in scenes, which reach no files, no system and no other code
while true do pcall(function() while true do end end) end
