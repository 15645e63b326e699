-- expect: :2: dofile: not available in scenes, which reach no files, no system and no other code
dofile("/etc/passwd")
