-- expect: :2: controls: expected a key, a gamepad's button, or a label of a button or slider
controls { sends = "go" }
sphere { radius = 1 }
