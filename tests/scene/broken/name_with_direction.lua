-- expect: :2: sphere.name: expected text of 1 to 47 bytes without control characters, got "a?b"
sphere { radius = 1, name = "a\u{202e}b" }
