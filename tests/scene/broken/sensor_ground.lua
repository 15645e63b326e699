-- expect: :2: ground.sensor: unknown field
ground { sensor = true }
