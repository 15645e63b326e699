-- expect: :2: joint: unknown name: joints are ball, hinge, slider, fixed, universal and distance
joint { between = { "a", "b" } }
