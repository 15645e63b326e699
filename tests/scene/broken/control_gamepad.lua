-- expect: :2: controls.gamepad: expected a whole number from 0 to 16
controls { gamepad = 17, sends = "go" }
sphere { radius = 1 }
