-- expect: :2: box.inertia: expected mass with it
box { size = { 1, 1, 1 }, inertia = { 1, 1, 1 } }
