-- expect: :2: scene.update_rate: expected with sync = "free" only
scene { update_rate = 100 }
