-- expect: :2: io: not available in scenes, which reach no files, no system and no other code
io.open("/etc/passwd")
