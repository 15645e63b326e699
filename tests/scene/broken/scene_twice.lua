-- expect: :3: scene: expected once, got a second time
scene {}
scene {}
