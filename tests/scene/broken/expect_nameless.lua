-- expect: expect: expected a name first, as in expect { "way", below = .01, function(run) ... end }
ground {}
expect { below = 1, function(run) return 0 end }
