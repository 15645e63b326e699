-- expect: expect.blow: unknown field, did you mean below?
ground {}
expect { "way", blow = 1, function(run) return 0 end }
