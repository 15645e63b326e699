-- expect: :2: scene.sleeping: expected true or false, got 1
scene { sleeping = 1 }
