-- expect: controls.to: expected the name of an object with a script, got "bal", did you mean "ball"?
sphere { radius = 1, name = "ball", script = "function on_start() end" }
controls { key = "w", sends = "go", to = "bal" }
