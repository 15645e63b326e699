-- expect: expect: expected at most 8 in a scene
ground {}
for i = 1, 9 do expect { "way", below = 1, function(run) return 0 end } end
