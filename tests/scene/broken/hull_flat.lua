-- expect: hull.points: expected points that are not all in one plane
ground {}
hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }, { .5, .5, 0 } } }
