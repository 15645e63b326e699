-- expect: expect: expected a function(run), got nothing
ground {}
expect { "way", below = 1 }
