-- expect: :2: collectgarbage: not available in scenes, which reach no files, no system and no other code
collectgarbage("stop")
