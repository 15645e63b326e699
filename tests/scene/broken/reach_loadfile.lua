-- expect: :2: loadfile: not available in scenes, which reach no files, no system and no other code
loadfile("/etc/passwd")
