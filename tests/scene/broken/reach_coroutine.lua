-- expect: :2: coroutine: not available in scenes, which reach no files, no system and no other code
coroutine.wrap(function() while true do end end)()
