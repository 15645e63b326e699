-- expect: :2: debug: not available in scenes, which reach no files, no system and no other code
debug.getregistry()
