-- expect: :3: unfinished string near
ground {}
box { name = "half }
