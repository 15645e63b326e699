-- expect: :2: _G: not available in scenes, which reach no files, no system and no other code
_G.io = 1
