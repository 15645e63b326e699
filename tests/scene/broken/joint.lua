-- expect: :2: joint: unknown name: obsim has no joints
joint { between = { "a", "b" } }
