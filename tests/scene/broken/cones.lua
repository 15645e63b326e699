-- expect: :3: cone: unknown name: obsim has no cones: hull { points = ... } makes one of its points
ground {}
cone { radius = 1, length = 2 }
