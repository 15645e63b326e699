-- expect: :2: os: not available in scenes, which reach no files, no system and no other code
os.execute("id")
