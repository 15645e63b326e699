-- expect: expect.below: expected a number of at least 0, got "1 mm"
ground {}
expect { "way", below = "1 mm", function(run) return 0 end }
